"""Runs the measurements of `contact bench` and `contact stability`; writes files and tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from contact.errors import unwarned
from contact.studies.bench import (
    curves,
    imports,
    machine,
    peers,
    plots,
    precision,
    report,
    scaling,
    stability,
)
from contact.studies.bench.cases import Case, suite
from contact.studies.bench.precision import Row
from contact.studies.bench.report import Table
from contact.studies.bench.scaling import Scaled


class Progress(Protocol):
    """An object that shows how many measurements are done, and lines with their results."""

    def __call__(self, stage: str, done: int, total: int | None) -> None: ...
    def say(self, line: str) -> None: ...


def bench(folder: Path, quick: bool, with_peers: bool, progress: Progress) -> list[Table]:
    """Measure errors against time and cost against size; write files and return the tables."""
    chosen: Sequence[peers.Peer] = peers.PEERS if with_peers else ()
    if with_peers:
        peers.require_both()
    # The commit is read first, because the source may change during the measurements.
    made = machine.commit()
    rows: list[Row] = []
    cases = suite(quick)
    total = len(cases) + sum(len(sizes) for _, sizes, _, _ in scaling.series(quick))
    with unwarned():
        for k, case in enumerate(cases):
            progress("measured", k, total)
            rows += _case(case, quick, chosen)
            progress.say(report.line_of_scene(rows, case.name))
    tables = [report.precision_table(rows), report.stated_table(rows), report.hierarchy_table(rows)]
    if chosen:
        tables += report.peers_tables(
            rows, [peer.name for peer in chosen], [case.name for case in cases if _asks_peers(case)]
        )
    scaled: list[Scaled] = []
    for row in scaling.measure(quick):
        scaled.append(row)
        progress("measured", len(cases) + len(scaled), total)
        progress.say(report.line_of_size(row))
    tables += [report.scaling_table(scaled), curves.table(quick), imports.table()]
    tables.append(machine.table([peer.name for peer in chosen]))
    report.write_csv(folder / "precision.csv", rows)
    report.write_csv(folder / "scaling.csv", scaled)
    plots.precision(rows, folder / "precision.png")
    if chosen:
        plots.peers(rows, folder / "peers.png")
    plots.scaling(scaled, folder / "scaling.png")
    _write(folder, tables, made)
    return tables


def _case(case: Case, quick: bool, chosen: Sequence[peers.Peer]) -> list[Row]:
    """Measure the solver, the localized models and other contact codes (peers) on one scene."""
    rows = list(precision.ours(case, quick))
    if case.localized:
        rows += precision.hierarchy(case, quick)
    for peer in chosen if _asks_peers(case) else ():
        rows += peers.rows(peer, case, quick, longest=0.5 if quick else 4.0)
    return rows


def _asks_peers(case: Case) -> bool:
    """Whether other contact codes (peers) can solve the scene: only if nothing acts in the gaps."""
    return case.law.routes.gaps


def extremes(folder: Path | None, quick: bool, progress: Progress) -> tuple[Table, int]:
    """Solve the extreme scenes; return (table of results, number of unexplained failures).

    The folder, if any, gets the tables of the pages and a CSV file of all scenes.
    """
    made = machine.commit()
    verdicts = stability.run_matrix(quick, progress)
    if folder is not None:
        report.write_csv(folder / "stability.csv", verdicts)
        tables = (report.stability_groups_table, report.stability_exceptions_table)
        _write(folder, [table(verdicts) for table in tables], made)
    return report.stability_table(verdicts), sum(verdict.outcome == "FAIL" for verdict in verdicts)


def _write(folder: Path, tables: list[Table], made: str) -> None:
    """Write tables in Markdown. Below each table stands `made`, the commit that was measured."""
    for table in tables:
        (folder / f"{table.key}.md").write_text(
            report.markdown(table) + f"\nMade at {made}.\n", encoding="utf-8"
        )
