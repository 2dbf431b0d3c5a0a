"""Rows as text."""

from attacks.row import GUARD_BYTES, RECOVERY_S
from attacks.server import MIB

HEADS = ["Row", "Attack", "Peak resident", "Given back", "/livez largest (99 %)", "Stranger's job", "Back to normal", "Answers", ""]


def cells(row):
    livez = row.times("livez")
    quantile = livez[int(0.99 * (len(livez) - 1))] if livez else 0.0
    peak = f"over {GUARD_BYTES >> 30} GB" if row.over else f"{row.peak // MIB} MiB"
    back = f"after {row.recovered_s:.0f} s" if row.recovered_s is not None else f"not in {RECOVERY_S:.0f} s"
    if row.over:
        back = "stopped"
    elif row.ended_s is not None:
        back = f"ended {row.ended_s:.0f} s after SIGTERM"
    given = "" if row.over or row.attack.slow_disk else f"{100 * row.given_back():.0f} % of {(row.peak - row.before) // MIB} MiB"
    refused = f", {row.refused()} refused" if row.refused() else ""
    answers = ", ".join(f"{n} x {how}" for how, n in sorted(row.answers.items(), key=lambda item: -item[1])[:4])
    verdict = "fails: " + ", ".join(row.faults()) if row.faults() else "holds"
    return [
        row.attack.name, row.attack.says, peak, given, f"{1000 * row.largest('livez'):.0f} ({1000 * quantile:.0f}) ms",
        f"{1000 * row.largest('stranger'):.0f} ms{refused}", back, answers, verdict,
    ]


def markdown(cells):
    return "| " + " | ".join(cells) + " |"


def line(row):
    return "; ".join(f"{head}: {cell}" if head else cell for head, cell in zip(HEADS, cells(row)))
