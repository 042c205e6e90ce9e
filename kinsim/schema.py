"""The JSON schema of scene files, for editors that complete keys and mark faults while one writes."""

from __future__ import annotations

import inspect
import re
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from .clock import Courant, Fixed
from .kinetic.velocity import Uniform
from .method import Kinetic
from .read import SceneFile
from .scene import Scene

BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
"""How a schema calls what pydantic checks."""

UNNAMED = tuple(kind.__name__ for kind in (Fixed, Courant, Kinetic, Uniform))
"""Variants that a table without a kind can be; see `kinsim.read`."""


def scene_schema() -> dict[str, Any]:
    """The JSON schema of scene files, of draft 7, which editors know; what spans several keys `kinsim check` judges."""
    template = "#/definitions/{model}"
    schema = TypeAdapter(SceneFile).json_schema(schema_generator=_Generator, ref_template=template)
    kinds = schema.pop("$defs")
    for made in kinds.values():
        what, _, _ = made["description"].partition("\n\nAttributes:")
        made["properties"] = _told(made["properties"], made["description"])
        made["description"] = " ".join(what.split())
    named: set[str] = set()
    _mend([schema, kinds], named)
    for name in named.difference(UNNAMED):
        kinds[name].setdefault("required", []).append("kind")
    schema["properties"] = _told(_told(schema["properties"], inspect.getdoc(Scene) or ""), schema["description"])
    schema["description"] = " ".join(schema["description"].partition("\n\nAttributes:")[0].split())
    return {"$schema": "http://json-schema.org/draft-07/schema#", **schema, "title": "scene", "definitions": kinds}


class _Generator(GenerateJsonSchema):
    """A number may be a formula; keys need no title."""

    def float_schema(self, schema: core_schema.FloatSchema) -> JsonSchemaValue:
        formula = {"type": "string", "description": 'a formula without variables, such as "pi/10"'}
        return {"anyOf": [super().float_schema(schema), formula]}

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def _told(properties: dict[str, Any], doc: str) -> dict[str, Any]:
    """The properties, each with its line of the docstring's attributes."""
    _, _, section = inspect.cleandoc(doc).partition("Attributes:\n")
    found = re.findall(r"^    (\w[\w, ]*): (.*(?:\n {8}.*)*)", section, re.MULTILINE)
    lines = {name: " ".join(text.split()) for names, text in found for name in names.split(", ")}
    return {name: ({"description": lines[name]} if name in lines else {}) | keys for name, keys in properties.items()}


def _mend(node: Any, named: set[str]) -> None:
    """Say it in draft 7, and note the variants that are told apart by their kind."""
    if isinstance(node, list):
        for part in node:
            _mend(part, named)
    if not isinstance(node, dict):
        return
    for bound in BOUNDS.keys() & node.keys():
        if isinstance(node[bound], int | float):
            node[BOUNDS[bound]] = node.pop(bound)
    if "prefixItems" in node:
        node["items"] = node.pop("prefixItems")
    if "discriminator" in node:
        named.update(place.rpartition("/")[2] for place in node.pop("discriminator")["mapping"].values())
    for part in node.values():
        _mend(part, named)
