//! The place of a part in its picture, kept inside the part's own file.
//!
//! `--tile K/N` renders the K-th of N bands of rows, from the top, each as high as the others or a row higher. The
//! file is an ordinary PNG or PFM of that band. Its place is one line of text, in a PNG as a `tEXt` chunk with the
//! keyword `rt-part` behind the header, in a PFM as a line `# rt-part ...` behind the last pixel, where readers have
//! stopped reading.

use rt_shade::Region;
use std::fmt;
use std::str::FromStr;

const KEYWORD: &str = "rt-part";
const PNG_SIGNATURE: &[u8; 8] = b"\x89PNG\r\n\x1a\n";
/// Signature, then the header chunk: length, name, 13 bytes, checksum.
const PNG_HEADER: usize = 8 + 4 + 4 + 13 + 4;

/// More than the text of a place can take.
const LONGEST_LINE: usize = 200;

/// The K-th of N parts, as given on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// From 1.
    pub number: u32,
    pub of: u32,
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Part, String> {
        let error = || format!("expected K/N with K from 1 to N, such as 3/8, got {text:?}");
        let (number, of) = text.split_once('/').ok_or_else(error)?;
        let (Ok(number), Ok(of)) = (number.parse(), of.parse()) else { return Err(error()) };
        if (1..=of).contains(&number) { Ok(Part { number, of }) } else { Err(error()) }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl Part {
    /// The first row of this part and the first row behind it. Bands of neighbouring parts meet; the first begins at
    /// 0 and the last ends at `height`.
    pub fn rows(self, height: u32) -> (u32, u32) {
        let edge = |k: u32| (u64::from(height) * u64::from(k) / u64::from(self.of)) as u32;
        (edge(self.number - 1), edge(self.number))
    }

    /// The band of a picture that covers `whole`; `None` when there are more parts than rows.
    pub fn region(self, whole: Region) -> Option<Region> {
        let (first, end) = self.rows(whole.height);
        let band = Region { y: whole.y + first, height: end - first, ..whole };
        (self.of <= whole.height).then_some(band)
    }
}

/// All that is needed to put a part where it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub part: Part,
    /// Columns of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// A hash of the scene's text and of the options that the pixels depend on: parts of different pictures do not
    /// fit together.
    pub picture: u64,
    /// Whether every pixel was rendered: not so after an interrupt.
    pub finished: bool,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Place { part, width, height, picture, finished } = self;
        let finished = if *finished { "yes" } else { "no" };
        write!(f, "part={part} size={width}x{height} picture={picture:016x} finished={finished}")
    }
}

impl Place {
    fn parse(text: &str) -> Option<Place> {
        let mut words = text.split_ascii_whitespace();
        let mut value = |key: &str| words.next()?.strip_prefix(key)?.strip_prefix('=');
        let part = value("part")?.parse().ok()?;
        let (width, height) = value("size")?.split_once('x')?;
        let (width, height) = (width.parse().ok()?, height.parse().ok()?);
        let picture = u64::from_str_radix(value("picture")?, 16).ok()?;
        let finished = match value("finished")? {
            "yes" => true,
            "no" => false,
            _ => return None,
        };
        Some(Place { part, width, height, picture, finished })
    }

    /// Puts the place into an encoded picture.
    pub fn attach(&self, file: &mut Vec<u8>) {
        if file.starts_with(PNG_SIGNATURE) && file.len() >= PNG_HEADER {
            let data = format!("{KEYWORD}\0{self}").into_bytes();
            let mut chunk = (data.len() as u32).to_be_bytes().to_vec();
            chunk.extend_from_slice(b"tEXt");
            chunk.extend_from_slice(&data);
            let checksum = crc32(&chunk[4..]);
            chunk.extend_from_slice(&checksum.to_be_bytes());
            file.splice(PNG_HEADER..PNG_HEADER, chunk);
        } else {
            file.extend_from_slice(format!("# {KEYWORD} {self}\n").as_bytes());
        }
    }

    /// Finds the place in an encoded picture, and the picture without it.
    pub fn find(file: &[u8]) -> Option<(Place, &[u8])> {
        let (text, picture) = if file.starts_with(PNG_SIGNATURE) {
            let length = u32::from_be_bytes(file.get(PNG_HEADER..PNG_HEADER + 4)?.try_into().ok()?) as usize;
            let chunk = file.get(PNG_HEADER + 4..)?.get(..length.checked_add(4)?)?;
            // Readers of PNG pass over the text.
            (chunk.strip_prefix(b"tEXt")?.strip_prefix(KEYWORD.as_bytes())?.strip_prefix(b"\0")?, file)
        } else {
            // The last line; a pixel may hold a line feed, the line itself does not.
            let line = file.strip_suffix(b"\n")?;
            let mark = format!("# {KEYWORD} ").into_bytes();
            let tail = line.len().saturating_sub(LONGEST_LINE);
            let start = tail + line[tail..].windows(mark.len()).rposition(|window| window == mark)?;
            (&line[start + mark.len()..], &file[..start])
        };
        Some((Place::parse(std::str::from_utf8(text).ok()?)?, picture))
    }
}

/// The checksum of PNG chunks (ISO 3309), bit by bit: it runs over a hundred bytes a file.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    };
    !bytes.iter().fold(!0, step)
}

/// Mixes bytes into a hash (FNV-1a, 64 bits): tells parts of different pictures apart, no protection against malice.
pub fn mix(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3))
}

/// The hash of nothing.
pub const EMPTY_HASH: u64 = 0xCBF2_9CE4_8422_2325;

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Place = Place {
        part: Part { number: 3, of: 8 },
        width: 1000,
        height: 77,
        picture: 0x0123_4567_89ab_cdef,
        finished: true,
    };

    #[test]
    fn parts_cover_every_row_once() {
        for height in [1, 2, 7, 1000, 65536] {
            for of in 1..=height.min(50) {
                let mut next = 0;
                for number in 1..=of {
                    let (first, end) = Part { number, of }.rows(height);
                    assert_eq!(first, next);
                    assert!(end > first);
                    next = end;
                }
                assert_eq!(next, height);
            }
        }
    }

    #[test]
    fn parts_are_read_and_refused() {
        assert_eq!("3/8".parse(), Ok(Part { number: 3, of: 8 }));
        for bad in ["", "3", "0/8", "9/8", "-1/8", "1/0", "1/8/2", "a/b", "1/99999999999"] {
            assert!(bad.parse::<Part>().is_err(), "{bad}");
        }
    }

    #[test]
    fn the_checksum_is_that_of_png() {
        // The chunk that ends every PNG.
        assert_eq!(crc32(b"IEND"), 0xAE42_6082);
    }

    #[test]
    fn places_survive_both_formats() {
        let picture = rt_shade::Picture::new(5, 4);
        for mut file in [picture.to_pfm(), picture.to_png().unwrap()] {
            assert_eq!(Place::find(&file), None);
            PLACE.attach(&mut file);
            let (place, rest) = Place::find(&file).unwrap();
            assert_eq!(place, PLACE);
            assert_eq!(rt_shade::Picture::decode(rest).unwrap(), picture);
        }
    }

    #[test]
    fn garbage_has_no_place() {
        for garbage in [
            &b""[..],
            b"\n",
            b"# rt-part\n",
            b"# rt-part part=1/2\n",
            PNG_SIGNATURE,
            b"\xff\xfe# rt-part \xff\n",
        ] {
            assert_eq!(Place::find(garbage), None);
        }
        let mut file = PNG_SIGNATURE.to_vec();
        file.extend_from_slice(&[0xff; 60]);
        assert_eq!(Place::find(&file), None);
    }
}
