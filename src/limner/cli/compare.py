"""`limner compare`: how different two pictures are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import click

from .destination import check_picture
from .options import as_json
from .talk import Talk
from .voice import voice

__all__ = ["compare"]

_DIFFERENT = 1
_GREATER_IS_BETTER = ("psnr", "ssim")


@dataclass(frozen=True)
class Order:
    """What a command line asks for."""

    reference: str
    test: str
    output: str | None
    picture: str
    gain: float
    metric: str
    fail_above: float | None
    fail_below: float | None
    as_json: bool


@click.command(short_help="Tell how different two pictures are.")
@click.argument("reference", metavar="A")
@click.argument("test", metavar="B")
@click.option("-o", "--output", metavar="OUT", help="A picture of where they differ.")
@click.option("--picture", type=click.Choice(["flip", "absolute"]), default="flip", show_default=True, help="What OUT shows.")
@click.option("--gain", type=click.FloatRange(0.0, min_open=True), default=10.0, show_default=True, help="Of --picture absolute.")
@click.option(
    "--metric", type=click.Choice(["rmse", "rel_mse", "psnr", "ssim", "flip"]), default="flip", show_default=True,
    help="What --fail-above and --fail-below look at.",
)  # fmt: skip
@click.option("--fail-above", type=float, metavar="X", help="Differ, for rmse, rel_mse and flip, means above X.")
@click.option("--fail-below", type=float, metavar="X", help="Differ, for psnr and ssim, means below X.")
@as_json()
@voice
@click.pass_obj
def compare(talk: Talk, /, **options: Any) -> None:
    """Tell how different the pictures A (the reference) and B are.

    The code is 0 where they are alike, 1 where they differ: in any bit, or beyond the threshold where there is one.

    \b
        limner compare before.png after.png -o difference.png
        limner compare reference.exr noisy.exr --metric rmse --fail-above 0.02
    """

    _compare(Order(**options), talk)


def _compare(order: Order, talk: Talk) -> None:
    """Fulfil `order`; the code is 1 where the pictures differ more than they may."""
    _check(order)
    from ..files.open_image import open_image
    from ..image.compare import compared, difference_picture

    reference, test = open_image(order.reference), open_image(order.test)
    found = compared(reference, test)
    if order.output is not None:
        difference_picture(reference, test, order.picture, order.gain).save(order.output)
    value = float(getattr(found, order.metric))
    too_different = _too_different(order, value, found.n_different)
    if order.as_json:
        _tell_json(order, found._asdict(), too_different)
    elif not talk.quiet:
        _tell(found._asdict())
    if too_different:
        limit = order.fail_below if order.metric in _GREATER_IS_BETTER else order.fail_above
        if limit is not None:
            side = "below" if order.metric in _GREATER_IS_BETTER else "above"
            talk.say("note", f"{order.metric} is {value:.6g}, {side} {limit:g}")
        talk.code = _DIFFERENT


def _too_different(order: Order, value: float, n_different: int) -> bool:
    """Without a threshold any difference counts."""
    if order.metric in _GREATER_IS_BETTER and order.fail_below is not None:
        return not value >= order.fail_below
    if order.metric not in _GREATER_IS_BETTER and order.fail_above is not None:
        return not value <= order.fail_above
    return n_different > 0


def _check(order: Order) -> None:
    if order.fail_above is not None and order.metric in _GREATER_IS_BETTER:
        raise click.UsageError(f"the greater {order.metric} is, the more alike pictures are: use --fail-below")
    if order.fail_below is not None and order.metric not in _GREATER_IS_BETTER:
        raise click.UsageError(f"the greater {order.metric} is, the less alike pictures are: use --fail-above")
    if order.output is not None:
        check_picture(order.output)


def _tell(found: dict[str, Any]) -> None:
    units = {"psnr": " dB"}
    for name, value in found.items():
        shown = f"{value}" if isinstance(value, int) else f"{value:.6g}"
        click.echo(f"{name:<15} {shown}{units.get(name, '')}")


def _tell_json(order: Order, found: dict[str, Any], too_different: bool) -> None:
    import json

    plain = {name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in found.items()}
    told = {"reference": order.reference, "test": order.test, **plain, "different": too_different}
    click.echo(json.dumps(told, sort_keys=True))
