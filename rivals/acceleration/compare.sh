#!/bin/sh
# Ours beside Embree (Debian: libembree-dev, g++) and the crates obvhs, bvh and parry3d-f64, one thread each:
#   compare.sh [-e] [N [ROUNDS [sphere|torus]]]   spheres, N of them (-e: Embree only)
#   compare.sh [-e] all [ROUNDS]                  10^2, 10^4, 10^6 spheres and 10^2, 10^4, 10^5 tori
# Ours and Embree take turns, so that both meet the machine as fast as it happens to be. Of single rays each has four tries in a round,
# of batches ours has four and Embree, whose single rays count there too, eight.
set -e
cd "$(dirname "$0")/.."
peers=yes
if [ "${1-}" = -e ]; then peers=no; shift; fi
n=${1:-10000} rounds=${2:-5} kind=${3:-sphere}
if [ "$n" = all ]; then
    [ $peers = no ] && only=-e || only=''
    for scene in '100 sphere' '10000 sphere' '1000000 sphere' '100 torus' '10000 torus' '100000 torus'; do
        acceleration/compare.sh $only "${scene% *}" "$rounds" "${scene#* }"
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
    printf '== %s %s, %s rays, %s rounds in turn\n' "$n" "$kind" "$rays" "$rounds"
    round=0
    while [ "$round" -lt "$rounds" ]; do
        round=$((round + 1))
        echo "round $round"
        # Embree is asked in two ways, twice each.
        ./target/release/cast "$kind" "$n" 4 "$rays"
        $embree "$kind" "$folder/shapes" "$folder/$rays" "$folder/answers" 2
        [ "$round" -lt "$rounds" ] && continue
        ./target/release/judge embree "$kind" "$n" "$rays" "$folder/answers"
        [ $peers = no ] || ./target/release/peers "$kind" "$n" 1 "$rays"
        echo end
    done | awk -v rounds="$rounds" '
        # The last round is printed whole; ratios are those of each round, for the speed of a machine changes.
        $1 == "round" { round = $2; next }
        $1 == "end" { complete = 1; next }
        round == rounds { print }
        / build / { build[$1, round] = $3 }
        /Mrays/ && !/any hit/ {
            for (i = 2; i <= NF; i++) if ($i == "Mrays/s") rate = $(i - 1)
            if ($1 == "ours") { own[$2, round] = rate; next }
            is_single = $2 == "single" || $2 == "single,"
            if ($1 == "embree") {
                if (is_single && rate > single[round]) single[round] = rate
                if (rate > best[round]) best[round] = rate
            } else if (is_single && rate > single_peer) { single_peer = rate; peer = $1 }
        }
        # The median, least and greatest of the ratios.
        function told(ratios,    i, j, x) {
            for (i = 2; i <= rounds; i++) {
                x = ratios[i]
                for (j = i - 1; j >= 1 && ratios[j] > x; j--) ratios[j + 1] = ratios[j]
                ratios[j + 1] = x
            }
            x = (ratios[int((rounds + 1) / 2)] + ratios[int((rounds + 2) / 2)]) / 2
            return sprintf("%.2f (%.2f-%.2f)", x, ratios[1], ratios[rounds])
        }
        END {
            if (!complete) exit 1
            for (r = 1; r <= rounds; r++) {
                singles[r] = own["single", r] / single[r]
                batches[r] = own["batch", r] / best[r]
                # Of few shapes it is too short to tell. Ours is the best of four, that of Embree of two.
                if (build["embree", r] >= 1) { built++; builds[r] = build["ours", r] / build["embree", r] }
            }
            printf "ours / embree, medians (least-greatest): single %s, batch / the best %s, time of build %s\n",
                told(singles), told(batches), built == rounds ? told(builds) : "-"
            if (peer) printf "the best peer: %s, single %.2f of ours\n", peer, single_peer / own["single", rounds]
        }'
done
