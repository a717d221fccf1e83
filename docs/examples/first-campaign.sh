#!/bin/sh
# From a clip to a report, without a camera: renders one shot, declares a
# campaign, logs the shot and builds the report. Usage: first-campaign.sh [FOLDER]
set -eu
out=${1:-touchdown-example}
mkdir -p "$out"
cd "$out"
touchdown simulate --example >scene.json
touchdown simulate scene.json --out clips
touchdown rig example >rig.toml
touchdown campaign new example --db lab.db --body sphere --diameter-mm 40 \
  --surface simulated --by "$(id -un)"
touchdown batch clips --db lab.db --campaign example --out evidence
touchdown list --db lab.db
touchdown next --db lab.db --campaign example
touchdown report --db lab.db --out report
echo "the report: $PWD/report/table1.html"
echo "the page:   touchdown review --db $PWD/lab.db"
