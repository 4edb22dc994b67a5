#!/bin/bash
# Runs the notebooks of examples/notebooks and keeps their outputs in them.
#
#   PYTHONPATH=FOLDER tools/run_notebooks.sh     FOLDER holds the package plenoflame; the command is in PATH
set -euo pipefail
cd "$(dirname "$0")/../examples/notebooks"
for notebook in *.ipynb; do
  /usr/bin/python3 -m nbconvert --to notebook --execute --inplace --ExecutePreprocessor.record_timing=False "$notebook"
  sed -i 's#[a-z/]*ipykernel_[0-9]*/[0-9]*\.py#notebook#' "$notebook"  # in warnings
done
