"""The result of a check."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree as xml

from .convention import ASE, Convention
from .failure import NeighbourFailure


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


@dataclass(frozen=True)
class NeighbourCheck:
    """The outcome of `check_neighbours`. It is true if all cases were tried, and none was wrong.

    Attributes
    ----------
    name : str
        The function's name.
    failures : list of NeighbourFailure
        At most one for each hard case; the first are reduced to the smallest system.
    systems : int
        Number of systems whose answers were compared with the truth.
    cases : dict
        ``right``, ``wrong``, ``refused`` (all systems), or ``not tried`` (not to the end) for each
        hard case.
    refused : dict
        Number of systems that the function declined, by reason.
    convention : Convention
        The convention, declared or recognised.
    recognised : bool
        Whether the convention was recognised.
    trouble : str
        The reason why no convention fits; otherwise empty.
    division : str
        ``exact`` or ``tolerant``.
    band : float
        The widest rounding band of the systems, in the tolerant division.
    seconds : float
        Time of the check.
    """

    name: str
    failures: list[NeighbourFailure]
    systems: int
    cases: dict[str, str]
    refused: dict[str, int]
    convention: Convention = ASE
    recognised: bool = False
    trouble: str = ""
    division: str = "exact"
    band: float = 0.0
    seconds: float = 0.0

    @property
    def verdict(self) -> str:
        """``right``, ``wrong``, or ``nothing`` if no answer was compared or the time was over."""
        if self.failures or self.trouble:
            return "wrong"
        late = "not tried" in self.cases.values()
        return "right" if self.systems and not late else "nothing"

    def __bool__(self) -> bool:
        return self.verdict == "right"

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> list[str]:
        def fill(text: str) -> str:
            return textwrap.fill(text, 80, subsequent_indent="  ", break_long_words=False)

        states = list(self.cases.values())
        tried = sum(state in ("right", "wrong") for state in states)
        late = [name for name, state in self.cases.items() if state == "not tried"]
        declined = _count(sum(self.refused.values()), "system") if self.refused else ""
        if "refused" in states:
            declined += f", {_count(states.count('refused'), 'case')} entirely"
        declined = declined and f"; refused {declined}"
        if self.trouble:
            lines = [f"WRONG: {self.name} fits no convention", fill(self.trouble)]
        elif self.failures:
            lines = [f"WRONG: {self.name} in {len(self.failures)} of {tried} hard cases{declined}"]
        elif late:
            lines = [
                f"NOT CHECKED: {self.name}, because the time was over; "
                f"right on {self.systems} systems, {tried} of {len(states)} hard cases to the end"
            ]
        elif self.systems:
            on = f"{_count(self.systems, 'system')} of {_count(tried, 'hard case')}"
            lines = [f"RIGHT: {self.name} on {on}{declined}"]
        else:
            lines = [f"NOT CHECKED: {self.name} answered no system"]
        how = "recognised" if self.recognised else "declared"
        if not self.trouble:
            lines.append(fill(f"convention, {how}: {self.convention}"))
        if self.recognised and replace(self.convention, systems="index") != ASE and not self.trouble:
            lines.append("If you meant the convention of ASE, give convention='ase'.")
        band = f", rounding band up to {self.band:.3g}" if self.division == "tolerant" else ""
        lines.append(f"division {self.division}{band}; {self.seconds:.1f} s")
        for reason, count in sorted(self.refused.items()):
            lines.append(fill(f"refused {_count(count, 'system')}: {reason}"))
        if late:
            lines.append(
                fill(f"not tried to the end, because the time was over: {', '.join(late)}")
            )
        # The most instructive failure first: explained, and small.
        shown = sorted(self.failures, key=lambda each: (each.cause is None, len(each.system)))
        if shown:
            lines += ["", str(shown[0])]
        if len(shown) > 1:
            lines.append("Also wrong:")
        for failure in shown[1:]:
            cause = f"; {failure.cause}" if failure.cause else ""
            lines.append(fill(f"  {failure.heading}{cause}"))
        return lines

    def junit(self) -> str:
        """Return the hard cases as a JUnit report."""
        suite = xml.Element(
            "testsuite",
            name=f"contactbench neighbours {self.name}",
            tests=str(len(self.cases) or 1),
            failures=str(len(self.failures) or int(bool(self.trouble))),
            skipped=str(sum(s in ("refused", "not tried") for s in self.cases.values())),
            time=f"{self.seconds:.3f}",
        )
        if self.trouble:
            test = xml.SubElement(suite, "testcase", classname=self.name, name="convention")
            xml.SubElement(test, "failure", message=self.trouble)
        failures = {failure.case: failure for failure in self.failures}
        for name, state in self.cases.items():
            test = xml.SubElement(suite, "testcase", classname=self.name, name=name)
            if state == "wrong":
                failure = failures[name]
                xml.SubElement(test, "failure", message=failure.heading).text = str(failure)
            elif state != "right":
                xml.SubElement(test, "skipped", message=state)
        xml.indent(suite)
        return xml.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"

    def save(self, folder: str | Path) -> list[Path]:
        """Write the report, a JUnit report, and each failure as .xyz and .py; return the files."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        texts = {"check.txt": f"{self}\n", "junit.xml": self.junit()}
        for number, failure in enumerate(self.failures, 1):
            stem = f"{number:02}-{re.sub('[^a-z0-9]+', '-', failure.case.lower())}"
            texts[f"{stem}.xyz"] = failure.xyz()
            texts[f"{stem}.py"] = failure.program()
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        return [folder / name for name in texts]
