"""A model from all sides on one sheet, and what a program can read about it without looking.

    python examples/contact_sheet.py sheet.png        writes sheet.png and sheet.json
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from limner.produce.views import views

MODEL = "teapot"


def main(target: str, small: bool = False) -> None:
    """Write the sheet, and the facts beside it."""
    sheet = views(MODEL, title=MODEL, size=128 if small else 320)
    sheet.image.save(target)
    Path(target).with_suffix(".json").write_text(json.dumps(sheet.facts, indent=2), encoding="utf-8")

    size = " x ".join(f"{edge:.3g}" for edge in sheet.facts["size"] or ())
    print(f"{MODEL}: {size} m, {sheet.facts['drawn_triangles']} triangles, {sheet.facts['up']['axis']} is up")
    for view in sheet.facts["views"]:
        print(f"  {view['name']:8} covers {view['coverage']:.0%}")
    for warning in sheet.facts["warnings"]:
        print(f"  ! {warning}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "contact_sheet.png", "--small" in sys.argv)
