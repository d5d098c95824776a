//! Tables, as text for the terminal, as Markdown and as CSV.

/// A titled table of strings.
pub struct Table {
    /// The file's name without ending.
    pub name: &'static str,
    /// The heading.
    pub title: &'static str,
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table.
    pub fn new(name: &'static str, title: &'static str, columns: &[&str]) -> Table {
        Table { name, title, columns: columns.iter().map(|c| c.to_string()).collect(), rows: Vec::new() }
    }

    /// Appends a row of as many cells as there are columns.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        assert_eq!(N, self.columns.len(), "{}: a row must fill all columns", self.name);
        self.rows.push(cells.into());
    }

    /// Aligned columns.
    pub fn text(&self) -> String {
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|k| self.rows.iter().chain([&self.columns]).map(|r| r[k].chars().count()).max().unwrap_or(0))
            .collect();
        let line = |cells: &Vec<String>| {
            let padded: Vec<String> =
                cells.iter().zip(&widths).map(|(c, w)| format!("{c:<w$}", w = *w)).collect();
            format!("{}\n", padded.join("  ").trim_end())
        };
        let rule = format!("{}\n", widths.iter().map(|w| "-".repeat(*w)).collect::<Vec<_>>().join("  "));
        format!(
            "{}\n{}{rule}{}",
            self.title,
            line(&self.columns),
            self.rows.iter().map(line).collect::<String>()
        )
    }

    /// A Markdown table.
    pub fn markdown(&self) -> String {
        let line = |cells: &Vec<String>| format!("| {} |\n", cells.join(" | "));
        let rule = format!("|{}\n", " --- |".repeat(self.columns.len()));
        format!("{}{rule}{}", line(&self.columns), self.rows.iter().map(line).collect::<String>())
    }

    /// Comma-separated values under a comment line that says where they come from.
    pub fn csv(&self, origin: &str) -> String {
        let quote = |c: &String| {
            if c.contains([',', '"']) { format!("\"{}\"", c.replace('"', "\"\"")) } else { c.clone() }
        };
        let line =
            |cells: &Vec<String>| format!("{}\n", cells.iter().map(quote).collect::<Vec<_>>().join(","));
        format!("# {origin}\n{}{}", line(&self.columns), self.rows.iter().map(line).collect::<String>())
    }
}
