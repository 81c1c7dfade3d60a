"""The dent that a sample slower than a steady cycle keeps: where it lies, found by Newton's method.

Memory that creeps slowly hardly changes over a cycle: the surface lies where the mean pressure of a
cycle holds it. A sample that hardly gives way at once answers a dent by pressures that are steep in
it, and cycles that start from what the last one left would throw it to and fro by many gaps.

A change of memory δy_m is felt in the middle of a cycle, where the contact is, as
v = Σ J_m c_m δy_m with c_m = e^(−T/2τ_m). At an instant it changes the load by
−(1 + J K D)⁻¹ K D v, where D = −p' is the steepness of the surface forces and J what gives way
within the cycle; the mean of that over the cycle changes what the elements gain. Attraction is left
out, so that the dent goes downhill.
"""

from typing import TYPE_CHECKING

import numpy as np

from softafm.bodies.stiffness import Stiffness
from softafm.errors import DivergedError
from softafm.solvers.energy.layout import LOAD
from softafm.solvers.energy.tuning import MUCH_SLOWER
from softafm.solvers.periodic import Mixing

if TYPE_CHECKING:
    from softafm.solvers.energy.surface import Surface
    from softafm.solvers.shapes import Shape

_LARGEST = 4.0
"""Step of Newton's method at first, in gaps."""
_BACK, _MOST_BACK = 0.3, 3
"""How far back a step goes that made the misses larger; how often, before another way is tried."""
_NEAR = 0.3
"""Misses, in gaps, that are not looked back at: they are errors of the cycles, too."""
_LOOKS = 80
"""Instants of a cycle at which the contact is looked at."""


class Dent:
    """Seeks the memory with which a cycle of a ``period``, s, ends as it began."""

    def __init__(self, surface: "Surface", period: float):
        compliance, times = surface.parameters.compliance, surface.parameters.retardation
        part = period / times
        self._surface, self._period = surface, period
        self._compliances = compliance[1:]
        self._gaining = -np.expm1(-part)[:, None]
        self._felt = np.exp(-part / 2)
        self._gained = part * self._felt / self._gaining[:, 0]
        self._slow = float(self._compliances @ (self._felt * self._gained))
        self._fast = float(compliance.sum()) - self._slow
        self._last, self._part, self._largest = np.inf, 1.0, _LARGEST
        self._backs, self._attracted = 0, False
        self._mixing = Mixing(self._compliances[:, None])
        self._start = self._step = np.empty(0)

    @property
    def rules(self) -> bool:
        """Whether a cycle feels the dent far more than what gives way within it."""
        return self._slow > MUCH_SLOWER * self._fast

    def guess(self, lowest: float) -> np.ndarray | None:
        """Return the memory of a sample that has crept to rest under the tip as at ``lowest``, s.

        That lies within a few gaps of where the mean pressure does it. None if there is no rest.
        """
        surface = self._surface
        kept, parameters = surface.keep(), surface.parameters
        relaxed = np.zeros_like(parameters.compliance)
        relaxed[0] = parameters.compliance.sum()
        height = float(surface.functions.height(lowest, parameters.height))
        frame = max(surface.contact.contact_radius(height), surface.open_frame)
        mesh = surface.build_mesh(surface.first_level + 2)
        surface.archive = mesh, frame
        surface.lay(mesh)
        surface.fields = np.zeros((len(surface.fields), mesh.nodes.size))
        surface.clock["frame"], surface.clock["time"] = frame, lowest
        surface.parameters = parameters._replace(compliance=relaxed)
        try:
            surface.settle()
            return self._felt[:, None] * surface.fields[LOAD]
        except DivergedError:
            return None
        finally:
            surface.parameters = parameters
            surface.restore(kept)

    def next_start(
        self, start: np.ndarray, gained: np.ndarray, records: np.ndarray, shapes: "list[Shape]"
    ) -> tuple[np.ndarray, float]:
        """Return the memory to start the next cycle with, and how far the last start was off, m.

        ``start`` and ``gained`` as in ``PeriodicMemory``; ``records`` and ``shapes`` are those of
        the cycle that gained it. The start was off by what Newton's method moves the dent by.
        """
        miss = gained / self._gaining - start
        raw, unit = self._measure(miss), self._surface.edge_gap
        if raw > max(self._last, _NEAR * unit) and self._backs < _MOST_BACK:  # too far: go back
            self._backs += 1
            self._mixing.forget()
            self._part *= _BACK
            self._largest = max(_BACK * self._largest, 1.0)
            return self._start + self._part * self._step, raw
        if self._backs == _MOST_BACK:
            self._attracted = not self._attracted
        self._backs = 0
        answer = self._answer(records, shapes)
        step = self._solve(answer, miss)
        off = self._measure(step)
        self._start, self._last = start, raw
        self._part = min(1.0, self._largest * unit / max(off, 1e-300))
        self._step = step
        if self._part < 1:
            self._mixing.forget()
            return start + self._part * step, min(raw, off)
        return self._mixing.next_trial(start, step), min(raw, off)

    def _measure(self, memory: np.ndarray) -> float:
        """Return the largest displacement of the surface by a memory, m."""
        return float(np.abs(self._compliances @ memory).max())

    def _solve(self, answer: np.ndarray, miss: np.ndarray) -> np.ndarray:
        """Return δy of δy_m = miss_m − b_m A v, b_m what is gained of a change of load."""
        felt = (self._compliances * self._felt) @ miss
        v = np.linalg.solve(np.eye(felt.size) + self._slow * answer, felt)
        return miss - self._gained[:, None] * (answer @ v)

    def _answer(self, records: np.ndarray, shapes: "list[Shape]") -> np.ndarray:
        """Return A = ⟨(1 + J K D)⁻¹ K D⟩ of a cycle, Pa, shape (nodes, nodes)."""
        mesh, frame = self._surface.archive
        stiffness = self._find_stiffness()
        law, radius = self._surface.contact.surface, frame * mesh.nodes
        tip = self._surface.contact.tip.profile(radius)
        time = records["time"]
        widths = np.gradient(time) if time.size > 1 else np.zeros(1)
        near = np.flatnonzero(records["axis"] - records["height"] > -self._surface.open_gap)
        every = max(1, near.size // _LOOKS)
        answer = np.zeros((radius.size, radius.size))
        for i in near[::every]:
            shape = shapes[i]
            displaced = np.interp(radius, shape.frame * shape.mesh.nodes, shape.deformation)
            steep = -law.slope(records["height"][i] + tip - displaced)
            if not self._attracted:
                steep = np.fmax(steep, 0.0)
            pushed = np.diag(frame * mesh.masses * steep)
            part = every * widths[i] / self._period
            answer += part * np.linalg.solve(stiffness + self._fast * pushed, pushed)
        return answer

    def _find_stiffness(self) -> np.ndarray:
        """Return S of the body on the mesh that the memory is kept on, shape (nodes, nodes)."""
        mesh, frame = self._surface.archive
        body = self._surface.contact.body
        uniform = Stiffness(body, mesh).uniform
        return np.linalg.inv(body.influence(mesh, frame)) if uniform is None else uniform
