"""One process for spoilt inputs. It reads kinds and seeds from stdin, a line in and a line out. An input may kill it."""

from __future__ import annotations

import ctypes
import json
import re
import resource
import sys
import time
import traceback
import warnings
from pathlib import Path
from random import Random

from tests.fuzz.inputs import KINDS, warm
from tests.fuzz.messages import MESSAGES

STATUS, FORGET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
MOST_ADDRESSES = 6 << 30  # to protect the machine; what is judged is how much memory was really used
ALL = {name: work for name, (work, _) in KINDS.items()} | MESSAGES


def processed(kind: str, seed: int) -> dict[str, object]:
    """What became of one input: accepted, refused in a sentence, or a traceback."""
    if FORGET.exists():
        ctypes.CDLL(None).malloc_trim(0)  # what earlier inputs needed may be free, and yet not given back
        FORGET.write_text("5")  # the most memory so far
    began = time.process_time()  # however busy the machine is
    try:
        outcome, words = ALL[kind](Random(f"{kind} {seed}")), ""
    except ValueError as error:
        outcome, words = "refused", str(error)
        if not words or "\n" in words.strip() or len(words) > 2000:
            outcome = "no sentence"
    except Exception:
        outcome, words = "traceback", traceback.format_exc()
    return {"outcome": outcome, "words": words[-3000:], "seconds": time.process_time() - began, "mib": peak_mib()}


def peak_mib() -> int:
    """The most memory that this process has used, on Linux for this input alone. What `getrusage` says there includes the
    process that started this one."""
    if STATUS.exists():
        return int(re.search(r"VmHWM:\s+(\d+) kB", STATUS.read_text())[1]) >> 10  # type: ignore[index]
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10


def main() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_ADDRESSES, MOST_ADDRESSES))
    warnings.simplefilter("error", RuntimeWarning)
    warm()
    for line in sys.stdin:
        print(json.dumps(processed(*json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
