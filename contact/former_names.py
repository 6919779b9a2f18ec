"""Names that stood at the top of the package once, and where they stand now."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from contact.io.former import by_room

FORMER: Mapping[str, str] = MappingProxyType(by_room(
    {
        "bodies": "Forcing HingedBeam Part ThinRing ring_elements ring_modes",
        "gaps": (
            "BodyForce Cantilever Closing HandPair ModalPair Side Start Stiffening Whirl rim_contact rod_modes settled"
        ),
        "growth": "StabilityMap poles rim_stability stability",
        "record": "EnergyBudget",
        "scene": "SceneError load_stability scene_schema",
        "scheme": "CDLagrange HHT MasslessBoundary NonsmoothAlpha PaoliSchatzman ProjectedAlpha StabilisedNewmark",
    },
    {"Profile": "RimProfile", "Tip": "ContactPoint"},
))  # fmt: skip
