//! Judges the parameters that another program wrote: `judge NAME sphere|torus N primary|random FILE`.

use rivals_acceleration::*;

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, kind, n, rays, file] = &arguments[..] else {
        eprintln!("usage: judge NAME sphere|torus N primary|random FILE");
        std::process::exit(2);
    };
    let geometry = scene(kind, n.parse().unwrap_or(10_000)).build();
    let rays = if rays == "primary" { primary(1024) } else { random(1 << 20) };
    let bytes = std::fs::read(file)?;
    let answers: Vec<f64> =
        bytes.chunks_exact(8).map(|eight| f64::from_ne_bytes(eight.try_into().expect("eight"))).collect();
    judge(name, &geometry, &rays, &answers);
    Ok(())
}
