"""How many false closures the back end survives, on graphs: the RMSE to the solution without them, and the time.

    python -m benchmarks.back_end                            # the graphs made up here, and those in ../shared/data
    python -m benchmarks.back_end some.g2o --lies 10 200     # one's own, too

Places are chosen at random and said to be one. The clean solution is that of the graph without lies, by an optimiser
that doubts nothing. The bar: with 200 lies 0.1 m to the clean solution, in 0.5 s.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from benchmarks.back_end.rows import DATA, LIES, Row, graphs, line, rows
from disk import require_writable, write_whole


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.back_end", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE.g2o", help="more graphs")
    parser.add_argument(
        "--lies", type=int, nargs="+", default=list(LIES), metavar="N", help="numbers of false closures"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the false closures (default 1)")
    parser.add_argument("--claims", type=float, metavar="M", help="sigma that all rows claim (default: what is true)")
    parser.add_argument("--data", type=Path, default=DATA, metavar="FOLDER", help="with the graphs of others")
    parser.add_argument("--report", type=Path, metavar="FILE", help="write the rows to FILE as JSON")
    args = parser.parse_args(argv)
    if min(args.lies) < 1 or args.seed < 0:
        parser.error("--lies must be 1 or more, --seed 0 or more")
    if args.claims is not None and not 0.001 <= args.claims <= 10:
        parser.error(f"--claims must be from 0.001 to 10 m, got {args.claims:g}")
    try:
        require_writable("--report", args.report)
    except (OSError, ValueError) as error:
        parser.error(str(error))
    told: list[Row] = []
    try:
        for graph in graphs(args.data, args.files):
            claimed = graph if args.claims is None else graph.claiming(args.claims)
            for row in rows(claimed, tuple(args.lies), args.seed):
                print(line(row), flush=True)
                told.append(row)
    except (OSError, ValueError) as error:
        print(f"{error}", file=sys.stderr)
        return 2
    finally:
        if args.report is not None:
            write_whole(args.report, json.dumps(told, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
