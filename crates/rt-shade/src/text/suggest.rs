//! The nearest word: what a misspelt key or name was probably meant to be.

/// The candidate nearest to `word`, if it is near enough to be a slip of the pen.
///
/// Near enough is a distance of a third of the word's length, at least one; letter case is ignored. Of equally near
/// candidates the first wins.
pub(crate) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word: Vec<char> = word.chars().flat_map(char::to_lowercase).collect();
    // A word too long to be a slip costs no quadratic time.
    if word.len() > 64 {
        return None;
    }
    let allowed = (word.len() / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let letters: Vec<char> = candidate.chars().flat_map(char::to_lowercase).collect();
        if letters.len().abs_diff(word.len()) > allowed {
            continue;
        }
        let d = distance(&word, &letters);
        if d <= allowed && best.is_none_or(|(least, _)| d < least) {
            best = Some((d, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// What to try instead of an unknown `word`: the nearest candidate, or the list of all of them when it is short.
pub(crate) fn advice<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str> + Clone,
    none: &str,
) -> String {
    if let Some(meant) = nearest(word, candidates.clone()) {
        return format!("did you mean `{meant}`?");
    }
    let mut all: Vec<&str> = candidates.into_iter().collect();
    if all.is_empty() {
        return none.to_string();
    }
    let more = all.len().saturating_sub(12);
    all.truncate(12);
    let mut text = format!("known are `{}`", all.join("`, `"));
    if more > 0 {
        text.push_str(&format!(" and {more} more"));
    }
    text
}

/// The number of insertions, deletions, replacements and swaps of neighbours that lead from one word to the other
/// (optimal string alignment: no part is edited twice).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_slips_and_leaves_strangers() {
        let words = ["center", "radius", "major", "minor"];
        assert_eq!(nearest("raduis", words), Some("radius"));
        assert_eq!(nearest("Radius", words), Some("radius"));
        assert_eq!(nearest("centre", words), Some("center"));
        assert_eq!(nearest("miner", words), Some("minor"));
        assert_eq!(nearest("colour", words), None);
        assert_eq!(nearest("", words), None);
        assert_eq!(nearest(&"radius".repeat(100), words), None);
        assert_eq!(advice("zzz", ["ab", "cd"], ""), "known are `ab`, `cd`");
        assert_eq!(advice("zzz", [], "none are defined"), "none are defined");
    }

    #[test]
    fn distance_counts_edits() {
        let d = |a: &str, b: &str| distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!(d("", ""), 0);
        assert_eq!(d("abc", ""), 3);
        assert_eq!(d("abc", "acb"), 1);
        assert_eq!(d("kitten", "sitting"), 3);
    }
}
