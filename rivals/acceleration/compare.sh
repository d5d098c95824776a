#!/bin/sh
# Ours and Embree's (Debian: libembree-dev, g++) in turn, on N spheres: compare.sh [N] [passes]
set -e
cd "$(dirname "$0")/.."
n=${1:-10000}
passes=${2:-3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo build --release --quiet -p rivals-acceleration
c++ -std=c++17 -O3 -march=native acceleration/embree.cpp -lembree3 -o "$folder/embree"
./target/release/dump "$n" "$folder"
for rays in primary random; do
    ./target/release/cast sphere "$n" "$passes" "$rays"
    "$folder/embree" "$folder/spheres" "$folder/$rays" "$passes"
done
