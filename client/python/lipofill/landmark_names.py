"""Names of landmarks in common schemes, as the command line understands them."""

from __future__ import annotations

import re
from typing import Optional, Tuple

_MIDLINE = {
    "nasion": ("nasion", "n", "na"),
    "pronasale": ("pronasale", "prn", "pn", "nosetip"),
    "subnasale": ("subnasale", "sn"),
    "pogonion": ("pogonion", "pg", "pog"),
    "menton": ("menton", "me"),
}
_PAIRED = {
    "exocanthion": ("exocanthion", "ex", "exo", "exc", "exocanthus"),
    "cheilion": ("cheilion", "ch", "chelion"),
    "gonion": ("gonion", "go"),
    "zygion": ("zygion", "zy", "zyg"),
    "tragion": ("tragion", "t", "tr", "tra", "tragus"),
    "alare": ("alare", "al"),
}
_NAME_OF = {alias: name for name, aliases in {**_MIDLINE, **_PAIRED}.items() for alias in aliases}
_SIDE_OF = {word: side for side in ("left", "right") for word in (side, side[0], side[0] + "t")}
_FILLERS = ("soft", "tissue", "landmark", "lm")


def _split_glued(word: str) -> Tuple[Optional[str], str]:
    """A side at the front or the back of one word: "gor", "lgo", "gonionleft"."""
    for text, side in _SIDE_OF.items():
        if word.endswith(text) and word[: -len(text)] in _NAME_OF:
            return side, word[: -len(text)]
        if word.startswith(text) and word[len(text) :] in _NAME_OF:
            return side, word[len(text) :]
    return None, word


def understand_name(name: str) -> Optional[str]:
    """The name the daemon has for a landmark; None for one that is not known."""
    apart = re.sub("([a-z])([A-Z])", r"\1 \2", name.replace("'", ""))
    words = [word for word in re.split("[^a-z0-9]+", apart.lower()) if word and word not in _FILLERS]
    side: Optional[str] = None
    if len(words) > 1:
        at = next((k for k, word in enumerate(words) if word in _SIDE_OF), None)
        side = None if at is None else _SIDE_OF[words.pop(at)]
    rest = "".join(words)
    if side is None and rest not in _NAME_OF:
        side, rest = _split_glued(rest)
    found = _NAME_OF.get(rest)
    if found is None or (found in _PAIRED) != (side is not None):
        return None
    return found if side is None else f"{found}_{side}"
