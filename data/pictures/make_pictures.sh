#!/bin/sh
# Makes the pictures of README.md again: data/pictures/make_pictures.sh [FOLDER]
# Needs ./dev build, and ImageMagick, which cuts them to a few colours (a third of the size).
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
out=${1:-$here}
asdic=$here/../../build/cli/asdic
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$asdic" run -q "$here/../scenes/mission.yaml" -o "$work/mission"
"$asdic" render -q "$work/mission" --images waterfall --beam forward --db-range 55:120 \
  --colormap inferno
"$asdic" run -q "$here/../scenes/scenario2.yaml" -o "$work/scenario2"
"$asdic" run -q "$here/../scenes/sonar_m750d.yaml" -o "$work/m750d"
convert "$work/mission/waterfall_forward.png" -colors 96 "$out/mission.png"
convert "$work/scenario2/ascope_0.png" -colors 32 "$out/scenario2.png"
"$asdic" view -q "$here/../scenes/mission.yaml" --snapshot 1 --pings 160 -o "$work/view"
convert "$work/view/view_159.png" -colors 128 "$out/view.png"
convert "$work/m750d/fan_0.png" -resize 60% -colors 96 "$out/m750d.png"
(cd "$work" && "$asdic" bench error -q --picture error.png)
convert "$work/error.png" -colors 48 "$out/error.png"
