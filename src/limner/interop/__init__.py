"""limner in the place of parts of other libraries: one module for each, named like it."""
