"""A scene of OpenUSD, read as it stands: z upwards, centimetres, a cage that is subdivided, exact solids, a sheet that may be seen through.

The file is written here, as text, in some twenty lines; `limner.load` turns the axes, takes metres, rounds the cage by Catmull and Clark,
and the light and the camera are the file's own. (Needs the extra `usd`.)

    python examples/usd_scene.py usd_scene.png
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import limner

STAGE = """#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 0.01
)
def Camera "view"
{
    float focalLength = 45
    float horizontalAperture = 36
    float verticalAperture = 24
    double3 xformOp:translate = (30, -760, 290)
    float xformOp:rotateX = 71
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}
def SphereLight "lamp"
{
    float inputs:radius = 40
    float inputs:intensity = 90
    double3 xformOp:translate = (-260, -260, 420)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def DomeLight "sky"
{
    color3f inputs:color = (0.5, 0.6, 0.75)
    float inputs:intensity = 0.5
}
def Mesh "cage"
{
    uniform token subdivisionScheme = "catmullClark"
    point3f[] points = [(-90,-90,0), (90,-90,0), (90,90,0), (-90,90,0), (-90,-90,180), (90,-90,180), (90,90,180), (-90,90,180)]
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0,3,2,1, 4,5,6,7, 0,1,5,4, 3,7,6,2, 0,4,7,3, 1,2,6,5]
    color3f[] primvars:displayColor = [(0.7, 0.2, 0.12)]
    double3 xformOp:translate = (-125, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Sphere "ball"
{
    double radius = 55
    color3f[] primvars:displayColor = [(0.85, 0.65, 0.2)]
    double3 xformOp:translate = (40, -60, 55)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Cone "cone"
{
    double height = 170
    double radius = 60
    color3f[] primvars:displayColor = [(0.2, 0.45, 0.5)]
    double3 xformOp:translate = (190, 30, 85)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "table"
{
    uniform token subdivisionScheme = "none"
    point3f[] points = [(-2000,-2000,0), (2000,-2000,0), (2000,2000,0), (-2000,2000,0)]
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    color3f[] primvars:displayColor = [(0.6, 0.6, 0.58)]
}
"""


def main(target: str, small: bool = False) -> None:
    """Write the stage, read it, see it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "table.usda"
        path.write_text(STAGE, encoding="utf-8")
        scene = limner.load(path)
    width, height, samples = (96, 64, 2) if small else (720, 480, 25)
    limner.render(scene, width=width, height=height, renderer="ray", samples=samples).save(target)
    print(f"{target}: {', '.join(placed.path for placed, _ in scene.shapes())}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "usd_scene.png", "--small" in sys.argv)
