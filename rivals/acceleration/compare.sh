#!/bin/sh
# Ours beside Embree (Debian: libembree-dev, g++) and the crates obvhs, bvh and parry3d-f64, one thread each:
#   compare.sh [-e] [N [PASSES [sphere|torus]]]   spheres, N of them (-e: Embree only)
#   compare.sh [-e] all [PASSES]                  10^2, 10^4, 10^6 spheres and 10^2, 10^4, 10^5 tori
set -e
cd "$(dirname "$0")/.."
peers=yes
if [ "${1-}" = -e ]; then peers=no; shift; fi
n=${1:-10000} passes=${2:-3} kind=${3:-sphere}
if [ "$n" = all ]; then
    [ $peers = no ] && only=-e || only=''
    for scene in '100 sphere' '10000 sphere' '1000000 sphere' '100 torus' '10000 torus' '100000 torus'; do
        acceleration/compare.sh $only "${scene% *}" "$passes" "${scene#* }"
    done
    exit
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cargo build --release --quiet -p rivals-acceleration
embree=target/embree
[ $embree -nt acceleration/embree.cpp ] ||
    c++ -std=c++17 -O3 -march=native acceleration/embree.cpp -lembree3 -o $embree
./target/release/dump "$kind" "$n" "$folder"
for rays in primary random; do
    printf '== %s %s, %s rays\n' "$n" "$kind" "$rays"
    {
        ./target/release/cast "$kind" "$n" "$passes" "$rays"
        $embree "$kind" "$folder/shapes" "$folder/$rays" "$folder/answers" "$passes"
        ./target/release/judge embree "$kind" "$n" "$rays" "$folder/answers"
        [ $peers = no ] || ./target/release/peers "$kind" "$n" 1 "$rays"
    } | awk '
        { print }
        / build / { if ($1 == "ours") own_build = $3; else if ($1 == "embree") build = $3 }
        /Mrays/ {
            rate = 0; for (i = 2; i <= NF; i++) if ($i == "Mrays/s") rate = $(i - 1)
            if ($0 ~ /any hit/) next
            if ($1 == "ours") own[$2] = rate
            else { if ($2 == "single" || $2 == "single,") { if (rate > one) { one = rate; one_name = $1 } }
                   if (rate > best) { best = rate; best_name = $0; sub(/ +[0-9.]+ Mrays.*/, "", best_name) } }
        }
        END {
            printf "ratio: single %.2f of the best single (%s), batch %.2f of the best (%s), build %.2f of the time of embree\n",
                own["single"] / one, one_name, own["batch"] / best, best_name, build ? own_build / build : 0
        }'
done
