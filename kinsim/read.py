"""Scene files: TOML to scene, method and clock. The built-in scenes are files too."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Sequence
from dataclasses import field, fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError

from .clock import Courant, Fixed
from .diagnostics.dump import Dump
from .errors import InputError
from .finding import one_line
from .method import Kinetic, Macroscopic, Method
from .scene import Scene
from .value import Number, Whole, value

BUILT_IN = Path(__file__).parent / "scenes"


def _clock_by_keys(given: Any) -> Any:
    """A clock's kind follows from its keys: dt and steps, or number and end."""
    if not isinstance(given, dict) or "kind" in given:
        return given
    if {"dt", "steps"} & given.keys() and {"number", "end"} & given.keys():
        raise ValueError("dt and steps, or number and end; keep one of the two pairs")
    return {"kind": "courant" if {"number", "end"} & given.keys() else "fixed", **given}


def _kinetic_unless_named(given: Any) -> Any:
    """A method is kinetic, and its velocities a uniform grid, where the file does not say."""
    if not isinstance(given, dict):
        return given
    velocity = given.get("velocity")
    named = {"velocity": {"kind": "uniform", **velocity}} if isinstance(velocity, dict) else {}
    return {"kind": "kinetic", **given, **named}


@value
class SceneFile(Scene):
    """What a scene file holds: the keys of a scene, the clock, and perhaps a method and the paper's figure.

    Attributes:
        save_at: Times at which the state is kept; a step ends on each.
        rows: So many times, evenly spread, instead.
    """

    clock: Annotated[Fixed | Courant, Field(discriminator="kind"), BeforeValidator(_clock_by_keys)] = field(
        kw_only=True
    )
    method: Annotated[Method, BeforeValidator(_kinetic_unless_named)] = Kinetic()
    save_at: tuple[Annotated[Number, Field(ge=0)], ...] | None = None
    rows: Annotated[Whole, Field(ge=1)] | None = None
    figure: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.save_at is not None and self.rows is not None:
            raise InputError("save_at and rows are given; keep one of them")

    @property
    def kept(self) -> dict[str, Any]:
        """Which states a run keeps, as `simulate` takes it."""
        asked = {"save_at": self.save_at, "rows": self.rows}
        return {name: value for name, value in asked.items() if value is not None}

    @property
    def scene(self) -> Scene:
        """The scene alone."""
        return Scene(**{key.name: getattr(self, key.name) for key in fields(Scene)})


def load_scene(name_or_path: str | Path) -> tuple[Scene, Kinetic | Macroscopic, Fixed | Courant]:
    """Read a scene.

    Args:
        name_or_path: The name of a built-in scene or the path of a TOML file; the path of a table in it is relative
            to the file's folder.

    Returns:
        Scene, method and clock as in the file; without a method in it the kinetic one.

    Raises:
        InputError: There is no such scene, or it is not as it should be; the message names file, key and remedy.
    """
    file = check(read_keys(name_or_path), str(name_or_path))
    return file.scene, file.method, file.clock


def built_in() -> dict[str, Path]:
    """The files of the built-in scenes by name, in the order of the paper's figures."""
    return {
        path.stem: path for path in sorted(BUILT_IN.glob("*.toml"), key=lambda path: str(read_keys(path)["figure"]))
    }


def read_keys(name_or_path: str | Path) -> dict[str, Any]:
    """The keys of a scene file as they stand there."""
    path = _find(name_or_path)
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise InputError(f"{name_or_path}: is no ordinary file; give the path of a scene file")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{name_or_path}: cannot be read: {error.strerror}; give the path of a scene file") from None
    keys = parse_keys(content, str(name_or_path))
    for table in (keys.get("heap"), _inside(keys, "chute", "zeta")):
        if isinstance(table, dict) and isinstance(table.get("path"), str):
            table["path"] = str(path.parent / table["path"])
    return keys


def _inside(keys: Any, *names: str) -> Any:
    """What stands at these names, one in another, or None."""
    for name in names:
        keys = keys.get(name) if isinstance(keys, dict) else None
    return keys


def parse_keys(content: bytes, place: str) -> dict[str, Any]:
    """The keys that a scene file with this content has; `place` names it where something is wrong."""
    try:
        return tomllib.loads(content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n"))
    except UnicodeDecodeError:
        raise InputError(f"{place}: is not UTF-8 text; give a scene file in TOML") from None
    except (tomllib.TOMLDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"{place}: is not TOML: {error}; correct it there") from None


def check(keys: dict[str, Any], place: str) -> SceneFile:
    """The keys of a scene file as values; `place` names the file where something is wrong."""
    try:
        return TypeAdapter(SceneFile).validate_python(keys)
    except ValidationError as error:
        raise InputError(one_line(error, place, SceneFile, separator=": ")) from None


def change(keys: dict[str, Any], settings: Sequence[str]) -> None:
    """Put settings ``friction.delta=pi/12`` over the keys of a scene file; a value is TOML, or else a string."""
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals or not all(part.strip() for part in name.split(".")):
            raise InputError(f"--set {setting}: is not key=value; write for example --set friction.delta=pi/12")
        put(keys, name, toml_value(text), f"--set {setting}")


def read_method(settings: Sequence[str]) -> Kinetic | Macroscopic:
    """The method that settings such as ``method.scheme=1`` make of scheme 4 in closed form.

    Raises:
        InputError: One is no setting of a method.
    """
    keys: dict[str, Any] = {"method": {"kind": "macroscopic"}}
    change(keys, settings)
    if set(keys) != {"method"}:
        other = next(name for name in keys if name != "method")
        raise InputError(f"--set {other}: there is no scene here; set keys of the method, such as method.scheme=1")
    try:
        method: Kinetic | Macroscopic = TypeAdapter(Method).validate_python(keys["method"])
    except ValidationError as error:
        raise InputError(one_line(error, "--set method", Kinetic, separator=": ")) from None
    return method


def put(keys: dict[str, Any], name: str, given: Any, place: str) -> None:
    """Put a value at a dotted name into the keys of a scene file; `place` names the request."""
    *tables, last = (part.strip() for part in name.split("."))
    table = keys
    for step in tables:
        table = table.setdefault(step, {})
        if not isinstance(table, dict):
            raise InputError(f"{place}: {step} is not a table of keys; leave out what follows it")
    table[last] = given


SHARED = ("scheme", "coupling", "order", "limiter", "statics")
"""Keys of a method that both wings have."""


def take_method(keys: dict[str, Any], kind: str) -> None:
    """Make `kind` the method; its scheme stays."""
    method = keys.get("method", {})
    if isinstance(method, dict) and method.get("kind", "kinetic") != kind:
        keys["method"] = {"kind": kind, **{key: method[key] for key in SHARED if key in method}}


def read_dumps(requests: Sequence[str]) -> list[Dump]:
    """Dumps from the command line, such as ``stage=transport,every=500,x=-2:2``; unnamed ones bear their stage's name.

    Raises:
        InputError: A key is unknown or its value is none.
    """
    dumps = []
    for request in requests:
        keys: dict[str, Any] = {}
        for part in filter(None, request.split(",")):
            key, equals, text = part.partition("=")
            if not equals:
                raise InputError(f"--dump {request}: {part!r} is not KEY=VALUE; write for example every=500")
            keys[key.strip()] = [toml_value(end) for end in text.split(":")] if ":" in text else toml_value(text)
        keys.setdefault("name", keys.get("stage", "force"))
        try:
            dumps.append(TypeAdapter(Dump).validate_python(keys))
        except ValidationError as error:
            raise InputError(one_line(error, f"--dump {request}", Dump, separator=": ")) from None
    return dumps


def _find(name_or_path: str | Path) -> Path:
    path, name = Path(name_or_path), str(name_or_path)
    if (BUILT_IN / f"{name}.toml").is_file():
        return BUILT_IN / f"{name}.toml"
    if path.exists() or path.suffix or len(path.parts) != 1:
        return path
    names = sorted(scene.stem for scene in BUILT_IN.glob("*.toml"))
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean {near[0]}?" if near else f"give a path, or one of {', '.join(names)}"
    raise InputError(f"{name}: no such scene; {hint}")


def toml_value(text: str) -> Any:
    """A value of TOML, or else the text itself."""
    try:
        keys = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, ValueError, RecursionError):
        return text.strip()
    return keys["value"] if len(keys) == 1 else text
