"""Pictures that explain rather than imitate (FoCG 10.3): the lines of a drawing, what hides them, and how they are drawn."""
