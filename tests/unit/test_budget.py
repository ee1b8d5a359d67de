"""When a picture is good enough, when time is up, and what is left of one whose process was killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limner.budget import Budget, Spending, noise_of
from limner.checkpoint import State, read_checkpoint, write_checkpoint
from limner.errors import FileFormatError, RenderError, SceneError, UnsupportedError
from limner.film import Film
from limner.render import Renderer, render
from limner.scene.library import builtin
from limner.tiles import Tile
from tests.staging import SLOW_AS_PYTHON

SIZE: dict[str, Any] = {"width": 24, "height": 20, "renderer": "path", "max_depth": 2}


class Noisy:
    """Work that adds random samples of mean 1 to a film, as much spread as a block's column says; the same for the same seed."""

    def __init__(self, film: Film, spread: float) -> None:
        self.film, self.spread, self.calls = film, spread, 0

    def __call__(self, tile: Tile, first: int, last: int) -> None:
        self.calls += 1
        for sample in range(first, last):
            random, spread = np.random.default_rng((tile.number, sample)), self.spread * (1 + tile.first_column)
            drawn = random.normal(1.0, spread, (tile.rows, tile.columns))
            block = self.film.sums[tile.first_row : tile.first_row + tile.rows, tile.first_column : tile.first_column + tile.columns]
            block += drawn[..., None].astype(np.float32)


def spent(samples: int, budget: Budget, spread: float = 0.05, step: int = 4) -> tuple[Film, Spending]:
    """A film of three blocks, the noise of which grows to the right, after a budget is spent."""
    film = Film(48, 16, 16)
    spending = Spending(film, Noisy(film, spread), samples, budget, "a picture")
    spending.passes(step, 1, lambda _: None, None)
    return film, spending


def test_noise_is_the_error_of_the_mean():
    """What is told of each block is the root mean square of its mean's true error, to a quarter."""
    film, half = Film(48, 16, 16), np.zeros((16, 48, 3), dtype=np.float32)
    work = Noisy(film, 0.02)
    for tile in film.tiles:
        film.expose(tile, work, 0, 32)
    half[:] = film.sums[..., :3]
    for tile in film.tiles:
        film.expose(tile, work, 32, 64)
    error = [np.sqrt(((film.sums[:, i : i + 16, 0] / 64 - 1.0) ** 2).mean()) for i in (0, 16, 32)]
    np.testing.assert_allclose(noise_of(film, half, 64), error, rtol=0.25)


def test_noisier_blocks_take_more_samples():
    film, spending = spent(4096, Budget(noise=0.05))
    assert film.taken[0] < film.taken[1] < film.taken[2] == spending.reached < 4096
    for block, taken in enumerate(film.taken):
        pixels = film.sums[:, 16 * block : 16 * block + 16, 0] / taken
        assert np.sqrt(((pixels - 1.0) ** 2).mean()) < 1.3 * 0.05


def test_a_black_picture_is_done_at_the_second_look():
    film = Film(16, 16, 16)
    spending = Spending(film, lambda *_: None, 4096, Budget(noise=0.01), "")
    spending.passes(4, 1, lambda _: None, None)
    assert spending.reached == 16


def test_time_ends_a_picture_between_two_passes():
    ticks = iter(range(1000))
    film = Film(16, 16, 16)
    spending = Spending(film, Noisy(film, 0.1), 1000, Budget(seconds=10.0), "", clock=lambda: float(next(ticks)))
    spending.passes(4, 1, lambda _: None, None)
    assert spending.is_out_of_time
    assert 0 < spending.reached < 1000
    assert spending.reached == film.taken[0]
    assert spending.reached % 4 == 0


def test_what_is_gone_on_with_has_the_bits_of_what_was_not_stopped(tmp_path):
    """Stopped at every pass of all, settled blocks and the half's sums included."""
    whole, _ = spent(128, Budget(noise=0.05))
    path = tmp_path / "kept"
    for reached in range(4, 124, 4):
        film = Film(48, 16, 16)
        budget = Budget(noise=0.05, checkpoint=path, interval=1e-9, resume=True)
        spending = Spending(film, Noisy(film, 0.05), 128, budget, "a picture")

        def report(_: float, spending: Spending = spending, reached: int = reached) -> None:
            if spending.reached > reached:
                raise InterruptedError

        with pytest.raises(InterruptedError):
            spending.passes(4, 1, report, None)
        assert spending.reached == reached + 4
    film = Film(48, 16, 16)
    Spending(film, Noisy(film, 0.05), 128, Budget(noise=0.05, checkpoint=path, resume=True), "a picture").passes(4, 1, lambda _: None, None)
    np.testing.assert_array_equal(film.sums, whole.sums)
    np.testing.assert_array_equal(film.taken, whole.taken)
    assert not path.exists()


def test_checkpoints_say_what_is_wrong_with_them(tmp_path):
    path = tmp_path / "kept"
    assert read_checkpoint(path, "a") is None
    film = Film(16, 16, 16)
    write_checkpoint(path, "a", State(8, film.sums, film.taken, film.sums[..., :3], film.taken > 0))
    with pytest.raises(RenderError, match="of another picture"):
        read_checkpoint(path, "b")
    with pytest.raises(RenderError, match="8 samples of each pixel, which are more than 4"):
        Spending(film, Noisy(film, 0.1), 4, Budget(checkpoint=path, resume=True), "a")
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(FileFormatError, match="no checkpoint"):
        read_checkpoint(path, "a")
    with pytest.raises(RenderError, match="cannot write the checkpoint"):
        write_checkpoint(tmp_path / "no" / "kept", "a", State(8, film.sums, film.taken, film.sums[..., :3], film.taken > 0))


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"noise": 0.0}, SceneError, "noise must be a positive number"),
        ({"time_limit": float("nan")}, SceneError, "time_limit must be a positive number"),
        ({"noise": 0.1, "renderer": "raster"}, UnsupportedError, 'for renderer="path"'),
        ({"noise": 0.1, "sampler": "jittered"}, UnsupportedError, "must know the number of samples"),
        ({"resume": True}, SceneError, "resume needs the checkpoint"),
        ({"checkpoint": 3}, SceneError, "checkpoint must be a path"),
    ],
)
def test_bad_budgets_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        Renderer(builtin("cornell"), **{**SIZE, **options})


@SLOW_AS_PYTHON
def test_noise_threads_and_tiles_change_no_bit():
    scene = builtin("cornell")
    pictures = [render(scene, **SIZE, noise=0.1, samples=64, threads=threads, tile_size=tile) for threads, tile in ((1, 8), (2, 64))]
    np.testing.assert_array_equal(pictures[0].pixels, pictures[1].pixels)
    assert pictures[0].recipe["noise"] == 0.1
    assert pictures[0].recipe["samples"] == 64


@SLOW_AS_PYTHON
def test_the_samples_that_time_allowed_make_the_same_picture():
    scene = builtin("cornell")
    timed = render(scene, **SIZE, time_limit=0.02)
    assert timed.finished
    again = render(scene, **SIZE, samples=timed.recipe["samples"])
    np.testing.assert_array_equal(timed.pixels, again.pixels)


_CHILD = """
import sys
import limner
limner.render("cornell", width=24, height=20, renderer="path", max_depth=2, samples=60000, checkpoint=sys.argv[1], checkpoint_seconds=0.01)
"""


@SLOW_AS_PYTHON
@pytest.mark.skipif(os.name != "posix", reason="kills with SIGKILL")
def test_a_killed_picture_is_gone_on_with(tmp_path):
    """A process that is killed leaves a whole checkpoint, from which the picture gets the bits that it would have had."""
    path = tmp_path / "kept"
    child = subprocess.Popen([sys.executable, "-c", _CHILD, str(path)], env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    began = time.monotonic()
    while not path.exists() and child.poll() is None and time.monotonic() - began < 60:
        time.sleep(0.005)
    child.send_signal(signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    with np.load(path) as held:
        reached = int(held["samples"])
    scene, samples = builtin("cornell"), reached + 6
    again = render(scene, **SIZE, samples=samples, checkpoint=path, resume=True)
    np.testing.assert_array_equal(again.pixels, render(scene, **SIZE, samples=samples).pixels)
    assert not path.exists()
    assert not list(Path(tmp_path).iterdir())
