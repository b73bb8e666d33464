#!/bin/sh
# Makes the pictures of README.md and docs again: data/pictures/make_pictures.sh [FOLDER]
# Needs ./dev build, and ImageMagick, which makes files smaller by a palette.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
out=${1:-$here}
asdic=$here/../../build/cli/asdic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Without dithering, which shows as grain in dark pictures.
shrink() {
  convert "$1" +dither -colors "$3" "$out/$2"
}

"$asdic" run -q "$here/../scenes/mission.yaml" -o "$work/mission"
"$asdic" run -q "$here/../scenes/scenario2.yaml" -o "$work/scenario2"
# What there is to see in that scene lies within 30 m.
sed "s#file: [^}]*#file: $here/../sonars/m750d.yaml, max_range_m: 31#" \
  "$here/../scenes/sonar_m750d.yaml" >"$work/m750d.yaml"
"$asdic" run -q "$work/m750d.yaml" -o "$work/m750d"
"$asdic" view -q "$here/../scenes/mission.yaml" --snapshot 1 --pings 160 -o "$work/view"
"$asdic" plan -q "$here/../scenes/scenario2_summer.yaml" --no-forecast --picture "$work/rays.png" >"$work/plan.txt"
(cd "$work" && "$asdic" bench error -q --picture error.png)
shrink "$work/mission/waterfall_forward.png" mission.png 256
shrink "$work/scenario2/ascope_0.png" scenario2.png 64
shrink "$work/m750d/fan_0.png" m750d.png 256
shrink "$work/error.png" error.png 48
shrink "$work/rays.png" rays.png 32
mkdir "$work/made"
python3 "$here/../generate/draw_laws.py" "$asdic" "$work/made"
cp "$work/made/pictures/laws.svg" "$out/laws.svg"
cp "$work/view/view_159.png" "$out/view.png" # has more colours than a palette holds
for obstacle in pile cliff; do # some minutes each
  "$asdic" trial -q "$here/../trials/$obstacle.yaml" --runs 200 --vary sonar.file=one.yaml,three.yaml,nine.yaml -o "$work/$obstacle"
  shrink "$work/$obstacle/trial.png" trial_$obstacle.png 32
done
