# What the examples of the published flights share; sourced by their run.sh.
#
#   QUADSONDE_BIN   the built program; default build/dev/cli/quadsonde
#   QUADSONDE_OUT   where the results go; default out/NAME

bin=${QUADSONDE_BIN:-build/dev/cli/quadsonde}
vehicle=examples/vehicles/published.toml

# 3: there is an answer, and something of the input was missing or doubtful, which has been said.
quadsonde() {
  local status=0
  "$bin" "$@" || status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then exit "$status"; fi
}

# fly SCENARIO: the flight and, apart from it, the wind that was really there.
fly() {
  log=$out/$(basename "$1" .toml).mcap
  quadsonde simulate "$1" -o "$log" --truth "$out/truth.csv" --force
}

# estimate MODE FILE [MORE...]: with the vehicle's file and the truth to be drawn.
estimate() {
  local mode=$1 file=$2
  shift 2
  quadsonde estimate "$log" --vehicle "$vehicle" --mode "$mode" --reference "$out/truth.csv" \
    -o "$out/$file" --force "$@" 2>> "$out/said.txt"
}

# The tables of the three filters, and the pictures: ours and the published filter in one, beside the truth.
tables_and_pictures() {
  : > "$out/said.txt"
  local mode
  for mode in smoothed causal classic; do estimate "$mode" "$mode.csv"; done
  estimate smoothed wind.svg
  estimate causal wind_causal.svg
  estimate smoothed state.svg --picture state
}

# error FILE FROM_S TO_S rms|mean: of the wind vector against the truth in a span of time [m/s].
error() {
  awk -F, -v from="$2" -v to="$3" -v what="$4" '
    FNR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
    { t = $at["time_s"] + 0; key = sprintf("%.1f", t); east = $at["wind_east_m_s"]; north = $at["wind_north_m_s"] }
    NR == FNR { true_east[key] = east; true_north[key] = north; next }
    t >= from + 0 && t < to + 0 && east != "" && key in true_east {
      e = east - true_east[key]; n = north - true_north[key]
      sum_e += e; sum_n += n; squares += e * e + n * n; ++count
    }
    END {
      if (!count) exit 1
      printf "%.3f", what == "rms" ? sqrt(squares / count) : sqrt(sum_e * sum_e + sum_n * sum_n) / count
    }' "$out/truth.csv" "$out/$1"
}

# claim NAME VALUE: what was found, beside what expected.txt of the example says; the worst is kept.
wrong=0
claim() {
  awk -v name="$1" -v found="$2" '
    $1 == name { known = 1; low = $2; high = $3; $1 = $2 = $3 = ""; sub(/^ +/, ""); text = $0 }
    END {
      holds = known && found >= low + 0 && found <= high + 0
      printf "%-52s %8.3f  %g to %g%s\n", known ? text : name, found, low, high, holds ? "" : "  <- not so"
      exit !holds
    }' "$here/expected.txt" || wrong=1
}

finish() {
  local file
  for file in "$@"; do
    if [ ! -s "$out/$file" ]; then
      echo "run.sh: $out/$file is not there" >&2
      exit 1
    fi
    echo "$out/$file"
  done
  exit "$wrong"
}
