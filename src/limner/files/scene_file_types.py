"""The types that `limner.files.scene_file_schema` makes of the descriptions. In here, by name, they find each other and themselves."""

from __future__ import annotations
