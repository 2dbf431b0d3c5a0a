#!/usr/bin/env bash
# The check of the action: JOBS and PICTURES are folders, BASE may name a revision, PLANISH a command. Ends as
# `planish figures --check` does; the report is left in planish-report.
set -euo pipefail
if [ -n "${PLANISH:-}" ]; then
  read -r -a planish <<<"$PLANISH"
else
  planish=(docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" --workdir /work planish-figures)
fi
report=planish-report
rm -rf "$report"
before=()
# the jobs of the base revision, where it has some
base=.planish-base
rm -rf "$base"
if [ -n "${BASE:-}" ] && git cat-file -e "$BASE:$JOBS" 2>/dev/null; then
  mkdir -p "$base"
  git archive "$BASE" "$JOBS" | tar -x -C "$base"
  before=(--before "$base/$JOBS")
fi
code=0
"${planish[@]}" figures "$JOBS" --output "$PICTURES" --check --report "$report" ${before[@]+"${before[@]}"} || code=$?
rm -rf "$base"
if [ -f "$report/report.md" ] && [ -n "${GITHUB_STEP_SUMMARY:-}" ]; then
  # the summary shows no pictures of the run; the report that is kept does
  sed -E '/^\| (before|after) /{N;N;d}' "$report/report.md" >>"$GITHUB_STEP_SUMMARY"
fi
exit "$code"
