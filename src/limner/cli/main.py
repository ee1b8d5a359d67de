"""`limner`: what becomes of a command line, whatever happens on the way.

A command ends with one of four codes: 0 done, 1 failed through no fault of the input (a full disk, a closed pipe), 2 wrong
usage or bad input, 130 interrupted. What went wrong is one line on standard error; `--traceback` shows where.
"""

from __future__ import annotations

import errno
import gc
import os
import sys
from collections.abc import Sequence

__all__ = ["main"]

FAILED, WRONG, INTERRUPTED = 1, 2, 130

_SELDOM = 100_000  # new objects between looks for cycles: a process of a second makes none worth 10 ms
_LONGEST = 400  # characters of a message that nobody wrote for people


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line (default: the process's own) and return its exit code."""
    if arguments is None:
        gc.set_threshold(_SELDOM)
        _stand_in_for_closed_streams()
    words = list(sys.argv[1:] if arguments is None else arguments)
    code = FAILED
    try:
        code = _run(words)
        sys.stdout.flush()
    except BrokenPipeError:
        _abandon_stdout()
        if "--traceback" in words:
            raise
        _say("whoever read standard output closed it")
        code = FAILED
    except OSError as error:
        _abandon_stdout()
        if "--traceback" in words:
            raise
        _say(_told(error))
        code = FAILED
    except KeyboardInterrupt:
        _say("interrupted")
        code = INTERRUPTED
        if arguments is None and "numba" in sys.modules:
            os._exit(code)  # LLVM, interrupted while it compiles, crashes when the interpreter takes it apart
    return code


def _run(words: Sequence[str]) -> int:
    import click

    from ..errors import LimnerError, RenderError
    from .commands import limner
    from .talk import Talk, flattened

    talk = Talk(traceback="--traceback" in words)
    try:
        with talk.listening(), limner.make_context("limner", list(words), obj=talk) as context:
            limner.invoke(context)
        return talk.code
    except click.exceptions.Exit as leave:
        return leave.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        sys.stderr.write(error.format_message() + "\n")
        return WRONG
    except (BrokenPipeError, KeyboardInterrupt):
        raise
    except click.UsageError as error:
        _say(flattened(error.format_message()) + _hint(error))
        return WRONG
    except RenderError as error:
        if talk.traceback:
            raise
        _say(flattened(str(error)))
        return FAILED
    except (LimnerError, FileNotFoundError, IsADirectoryError, PermissionError) as error:
        if talk.traceback:
            raise
        _say(flattened(str(error)))
        return WRONG
    except MemoryError as error:
        if talk.traceback:
            raise
        _say(f"not enough memory{': ' if str(error) else ''}{flattened(str(error))}")
        return FAILED
    except OSError:
        raise
    except Exception as error:
        if talk.traceback:
            raise
        said = flattened(str(error))[:_LONGEST] or "failed"
        _say(f"{said} ({type(error).__name__}, not foreseen; --traceback shows it)")
        return FAILED


def _told(error: OSError) -> str:
    """What the system refused. Files are named in what is raised for them; without a name it is standard output that took no more."""
    from .talk import flattened

    if error.filename is None and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EIO, errno.EBADF):
        return f"cannot write standard output: {error.strerror}"
    said = flattened(str(error))[:_LONGEST] or "failed"
    return f"{said} ({type(error).__name__}, not foreseen; --traceback shows it)"


def _hint(error: object) -> str:
    """Where to read on."""
    context = getattr(error, "ctx", None)
    return f" (see {context.command_path} --help)" if context is not None else ""


def _say(line: str) -> None:
    try:
        sys.stderr.write(f"limner: error: {line}\n" if line != "interrupted" else "limner: interrupted\n")
        sys.stderr.flush()
    except OSError:  # nobody is left to tell
        return


def _stand_in_for_closed_streams() -> None:
    """Open what the caller closed (``>&-``): what is told goes nowhere, and writing a result fails like on a full disk."""
    if sys.stdout is None:
        sys.stdout = open(os.open(os.devnull, os.O_RDONLY), "w", encoding="utf-8")  # noqa: SIM115 - open until the process ends
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 - likewise


def _abandon_stdout() -> None:
    """Let nothing more be flushed into a closed pipe when the process ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, sys.stdout.fileno())
    except (OSError, ValueError):
        return
    finally:
        os.close(nowhere)
