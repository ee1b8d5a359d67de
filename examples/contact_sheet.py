"""A model from all sides on one sheet, and what a program can read about it without looking.

python examples/contact_sheet.py [MODEL]        writes contact_sheet.png and contact_sheet.json; without MODEL, of the teapot
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from limner.produce.views import views


def main(model: str = "teapot", folder: Path = Path()) -> None:
    """Write the sheet and the facts into `folder`."""
    sheet = views(model, title=Path(model).name)
    sheet.image.save(folder / "contact_sheet.png")
    (folder / "contact_sheet.json").write_text(json.dumps(sheet.facts, indent=2), encoding="utf-8")

    size = " x ".join(f"{edge:.3g}" for edge in sheet.facts["size"] or ())
    print(f"{model}: {size} m, {sheet.facts['drawn_triangles']} triangles, {sheet.facts['up']['axis']} is up")
    for view in sheet.facts["views"]:
        print(f"  {view['name']:8} covers {view['coverage']:.0%}")
    for warning in sheet.facts["warnings"]:
        print(f"  ! {warning}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
