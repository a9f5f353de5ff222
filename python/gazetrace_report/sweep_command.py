# SPDX-License-Identifier: Apache-2.0
"""`gazetrace report`: a page, diagrams and their numbers of what a sweep measured."""

import sys
from pathlib import Path

from .command_line import Parser, add_json_option, check_output, json_file, say, with_json_joined, write
from .errors import Error


def parse(words):
    parser = Parser("gazetrace report", description="Make a page, diagrams and tables of the results of a sweep.")
    parser.add_argument("results", type=Path, help="results.json of a sweep, or its folder")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="the page; default: report.html beside the results")
    parser.add_argument("--plots", type=Path, metavar="DIR", help="writes every diagram as .svg and .pdf and its numbers as .csv; replaces them")
    parser.add_argument("--max-mib", type=float, default=5, metavar="MIB",
                        help="limit of the page: pictures are reduced, then left out, to stay below; the page says how (default: 5)")
    parser.add_argument("--overwrite", action="store_true", help="replaces the page that is there")
    add_json_option(parser)
    return parser.parse_args(with_json_joined(words))


def main(words):
    arguments = parse(words)
    if not arguments.max_mib > 0:
        raise Error("--max-mib: must be above 0")
    from .results import Results
    results = Results(arguments.results)
    output = arguments.output or results.folder / "report.html"
    check_output(output, arguments.overwrite, [results.file])
    json_file(arguments.json, arguments.overwrite, [results.file, output])
    said, warnings = make(results, output, arguments.plots, arguments.max_mib)
    for warning in warnings:
        print(f"gazetrace: warning: {warning}", file=sys.stderr)
    text = (f"{len(said['plots'])} diagrams in {arguments.plots}\n" if arguments.plots else "") + f"{output}: {len(results.rows)} runs, {said['bytes'] / 2**20:.2f} MiB\n"
    say(text, {**said, "warnings": warnings}, arguments.json)
    return 0


def make(results, output, plots, max_mib):
    """Writes the page and, into the folder `plots`, the diagrams; says what was made, and warnings."""
    from . import sweep_page
    drawn = sweep_page.draw(results, plots is not None)
    said = {}
    if plots:
        for diagram in drawn:
            write(plots / f"{diagram.name}.svg", diagram.svg)
            write(plots / f"{diagram.name}.pdf", diagram.pdf)
            write(plots / f"{diagram.name}.csv", diagram.numbers.to_csv(index=False, float_format="%.9g"))
        said["plots"] = [str(plots / f"{diagram.name}.svg") for diagram in drawn]
    page, warnings = sweep_page.make(results, drawn, max_mib)
    write(output, page)
    return {**said, "page": str(output), "runs": len(results.rows), "bytes": len(page.encode())}, warnings
