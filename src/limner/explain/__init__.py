"""Why a picture looks as it does: the story of one pixel, and what is wrong with a scene."""
