#!/usr/bin/env python3
"""Builds a LaTeX and a Typst document that include a figure of planish, and looks for its letters in both.

Usage: documents.py PLANISH

Needs pdftotext, the Python package typst and the font DejaVu Sans, and pdflatex with graphicx for LaTeX, which is passed
over where it is not installed. PDF holds its letters; Typst sets those of SVG with the fonts that it finds, and has all of them as outlines where the figure asks for that.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import typst

SQUARE = {"polygon": {"points": [[0, 0], [4, 0], [4, 3], [0, 3]], "closed": True}}


def panel(preset, caption):
    return {"job": {"input": SQUARE, "plan": {"preset": preset}, "levels": 4}, "caption": caption}


FIGURE = {
    "figure": {
        "columns": 2,
        "letters": True,
        "title": "Curves, \\alpha_{0} = 1",
        "panels": [panel("cubic-b-spline", "approximates"), panel("four-point", "interpolates")],
    },
    "outputs": [{"format": "pdf", "width": 800}, {"format": "svg", "width": 800}],
}
LATEX = r"""\documentclass{article}
\usepackage{graphicx}
\begin{document}
\includegraphics[width=\linewidth]{figure.pdf}
\end{document}
"""
TYPST = '#figure(image("figure.svg", width: 100%), caption: [A figure.])\n'
# letters of the captions and of the title, which LaTeX takes from the PDF and Typst from the SVG
LETTERS = ["(a) approximates", "(b) interpolates", "Curves"]


def main():
    planish = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "job.json").write_text(json.dumps(FIGURE))
        for kind in ["pdf", "svg"]:
            subprocess.run([planish, "render", "-q", "job.json", "-o", f"figure.{kind}"], cwd=folder, check=True)
        (folder / "latex.tex").write_text(LATEX)
        (folder / "typst.typ").write_text(TYPST)
        typst.compile(folder / "typst.typ", output=folder / "typst.pdf")
        built = ["typst"]
        if shutil.which("pdflatex"):
            latex = ["pdflatex", "-interaction=batchmode", "latex.tex"]
            subprocess.run(latex, cwd=folder, check=True, stdout=subprocess.DEVNULL)
            built.append("latex")
        else:
            print("--   latex: there is no pdflatex")
        for name in built:
            told = ["pdftotext", folder / f"{name}.pdf", "-"]
            text = " ".join(subprocess.run(told, check=True, capture_output=True, text=True).stdout.split())
            missing = [letters for letters in LETTERS if letters not in text]
            print(f"{'MISSING ' + str(missing) if missing else 'ok'}   {name}")
            if missing:
                sys.exit(1)


if __name__ == "__main__":
    main()
