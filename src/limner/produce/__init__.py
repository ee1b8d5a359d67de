"""Many pictures from one scene."""
