//! How to render, and what was counted.

use crate::Error;
use std::str::FromStr;

/// Where in a pixel the rays go.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Antialias {
    /// One ray through the centre.
    #[default]
    None,
    /// `n x n` rays through the centres of as many equal squares.
    Grid(u32),
    /// Rays through the corners, shared with the neighbours; a pixel whose corners differ by more than the
    /// threshold is split into quadrants, and so on until the depth.
    Adaptive {
        /// The largest difference of two corners in one channel, of 1.
        threshold: f64,
        /// How often a pixel may be split: `2^depth` rows of quadrants at most. Deeper than 2 only where an edge crosses it.
        depth: u32,
    },
}

impl Antialias {
    /// The adaptive way with its default threshold and depth.
    pub const ADAPTIVE: Antialias = Antialias::Adaptive { threshold: 0.05, depth: 3 };
    /// The largest `n` of [`Antialias::Grid`].
    pub const MOST_GRID: u32 = 64;
    /// The largest depth of [`Antialias::Adaptive`].
    pub const MOST_DEPTH: u32 = 6;

    fn is_legal(self) -> bool {
        match self {
            Antialias::None => true,
            Antialias::Grid(n) => (1..=Antialias::MOST_GRID).contains(&n),
            Antialias::Adaptive { threshold, depth } => {
                (0.0..=1.0).contains(&threshold) && (1..=Antialias::MOST_DEPTH).contains(&depth)
            }
        }
    }
}

impl std::fmt::Display for Antialias {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Antialias::None => write!(f, "none"),
            Antialias::Grid(n) => write!(f, "grid:{n}"),
            Antialias::Adaptive { threshold, depth } => write!(f, "adaptive:{threshold}:{depth}"),
        }
    }
}

/// `none`, `grid:N`, `adaptive` or `adaptive:THRESHOLD:DEPTH`.
impl FromStr for Antialias {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let words: Vec<&str> = text.split(':').collect();
        let parsed = match words[..] {
            ["none"] => Some(Antialias::None),
            ["grid", n] => n.parse().ok().map(Antialias::Grid),
            ["adaptive"] => Some(Antialias::ADAPTIVE),
            ["adaptive", threshold, depth] => match (threshold.parse(), depth.parse()) {
                (Ok(threshold), Ok(depth)) => Some(Antialias::Adaptive { threshold, depth }),
                _ => None,
            },
            _ => None,
        };
        parsed.filter(|a| a.is_legal()).ok_or_else(|| Error::Antialias { text: text.to_owned() })
    }
}

/// A part of a picture, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// The left column.
    pub x: u32,
    /// The top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Columns of the raster.
    pub width: u32,
    /// Rows of the raster.
    pub height: u32,
    /// The depth of the deepest rays: the eye ray is depth 1, deeper is black.
    pub max_depth: u32,
    /// Anti-aliasing.
    pub antialias: Antialias,
    /// How many threads; 0: as many as the machine has. Needs the feature `rayon`, else one thread works.
    pub threads: usize,
    /// Whether there are shadows.
    pub shadows: bool,
    /// One ray through each corner of the raster: a picture of `(width + 1) x (height + 1)` pixels. Excludes
    /// anti-aliasing.
    pub corners: bool,
    /// Only this part of the picture (with `corners`: of the picture of corners).
    pub region: Option<Region>,
    /// The edge of a tile in pixels.
    pub tile: u32,
    /// Mirror and transmitted rays that count for less than this share of the pixel are left out. 0: none are.
    pub cutoff: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            width: 640,
            height: 480,
            max_depth: 8,
            antialias: Antialias::None,
            threads: 0,
            shadows: true,
            corners: false,
            region: None,
            tile: 32,
            cutoff: 0.0,
        }
    }
}

impl Settings {
    /// The most pixels either way.
    pub const MOST_SIZE: u32 = 65536;
    /// The most depth.
    pub const MOST_DEPTH: u32 = 1000;
    /// The most threads.
    pub const MOST_THREADS: usize = 4096;

    /// Whether every number is legal.
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Region`], [`Error::Antialias`] or [`Error::Number`].
    pub fn check(&self) -> Result<(), Error> {
        let size = |what, value: u32, most: u32| {
            if (1..=most).contains(&value) {
                Ok(())
            } else {
                Err(Error::Size { what, value: value.into(), most: most.into() })
            }
        };
        size("image width", self.width, Self::MOST_SIZE)?;
        size("image height", self.height, Self::MOST_SIZE)?;
        size("max_depth", self.max_depth, Self::MOST_DEPTH)?;
        size("tile", self.tile, Self::MOST_SIZE)?;
        if self.threads > Self::MOST_THREADS {
            let (value, most) = (self.threads as u64, Self::MOST_THREADS as u64);
            return Err(Error::Size { what: "threads", value, most });
        }
        if !self.antialias.is_legal() || (self.corners && self.antialias != Antialias::None) {
            let with = if self.corners { " with corners" } else { "" };
            return Err(Error::Antialias { text: format!("{}{with}", self.antialias) });
        }
        if !(0.0..=1.0).contains(&self.cutoff) {
            return Err(Error::Number { what: "cutoff", range: "from 0 to 1", value: self.cutoff });
        }
        let (picture_width, picture_height) = self.picture_size();
        if let Some(Region { x, y, width, height }) = self.region {
            let inside = |from: u32, count: u32, whole: u32| {
                count > 0 && u64::from(from) + u64::from(count) <= u64::from(whole)
            };
            if !(inside(x, width, picture_width) && inside(y, height, picture_height)) {
                return Err(Error::Region { x, y, width, height, picture_width, picture_height });
            }
        }
        Ok(())
    }

    /// Columns and rows of the whole picture, the region left out of account.
    pub fn picture_size(&self) -> (u32, u32) {
        let more = u32::from(self.corners);
        (self.width + more, self.height + more)
    }

    /// What is rendered: the region, or the whole picture.
    pub fn extent(&self) -> Region {
        let (width, height) = self.picture_size();
        self.region.unwrap_or(Region { x: 0, y: 0, width, height })
    }
}

/// Counters of one rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Stats {
    /// Rays from the eye.
    pub eye_rays: u64,
    /// Those that hit something.
    pub eye_hits: u64,
    /// Shadow rays: one for each lamp that can light a point that was hit, however many surfaces it crosses.
    pub shadow_rays: u64,
    /// Those that were stopped.
    pub shadow_hits: u64,
    /// Mirror rays, total internal reflection included.
    pub reflected_rays: u64,
    /// Rays that went on through a surface.
    pub refracted_rays: u64,
    /// Mirror and transmitted rays that hit something.
    pub secondary_hits: u64,
}

impl Stats {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.eye_rays + self.shadow_rays + self.reflected_rays + self.refracted_rays
    }
}

impl std::ops::AddAssign for Stats {
    fn add_assign(&mut self, o: Stats) {
        self.eye_rays += o.eye_rays;
        self.eye_hits += o.eye_hits;
        self.shadow_rays += o.shadow_rays;
        self.shadow_hits += o.shadow_hits;
        self.reflected_rays += o.reflected_rays;
        self.refracted_rays += o.refracted_rays;
        self.secondary_hits += o.secondary_hits;
    }
}
