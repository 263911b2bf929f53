"""What Settings and Pose share: values by name, checked before anything is sent."""
from __future__ import annotations

import collections.abc
import dataclasses
import difflib
import math
import numbers
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, TypeVar

from google.protobuf.message import Message

F = TypeVar("F", bound="Fields")
M = TypeVar("M", bound=Message)


def hint(name: object, known: Iterable[str]) -> str:
    """"; did you mean r_max_m?" where a known name is near."""
    near = difflib.get_close_matches(str(name), list(known), n=1)
    return f"; did you mean {near[0]}?" if near else f"; known are {', '.join(known)}"


def numbers_of(call: str, name: str, value: object) -> tuple[float, ...]:
    """The values of a list, where all are finite numbers."""
    if isinstance(value, (str, bytes)) or not isinstance(value, collections.abc.Iterable):
        raise TypeError(f"{call}() got {name}={value!r}; allowed: a sequence of numbers")
    found = tuple(float(number(name, item)) for item in value)
    if not all(map(math.isfinite, found)):
        raise ValueError(f"{call}() got {name}={value!r}; allowed: finite numbers")
    return found


def number(name: str, value: object) -> float:
    """The value, where it is a number."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name}: found {value!r}; allowed: a number")
    return value  # type: ignore[return-value]  # numpy's are numbers, too


class Fields:
    """A frozen dataclass of optional values that a protobuf message of the same field names carries.

    choices: name -> the texts that it may have, and their numbers on the wire. keys: name in a scene file -> name here.
    ideal: the values that an ideal map has: with another, bins are more than its echoes.
    """

    choices: ClassVar[dict[str, dict[str, int]]] = {}
    keys: ClassVar[dict[str, str]] = {}
    ideal: ClassVar[dict[str, Any]] = {}

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Of all values."""
        return tuple(_types(cls))

    @classmethod
    def of(cls: type[F], given: F | Mapping[str, Any] | None = None, call: str | None = None, **more: Any) -> F:
        """From an object of this class, a mapping, None, and keywords that override it. TypeError for a name that
        does not exist or a value of the wrong type, ValueError for an unknown choice."""
        call = call or cls.__name__
        if given is None:
            base: dict[str, Any] = {}
        elif isinstance(given, cls):
            base = given.as_dict()
        elif isinstance(given, collections.abc.Mapping):
            base = dict(given)
        else:
            raise TypeError(f"{call}() got {type(given).__name__}; allowed: {cls.__name__} or a dict")
        base.update(more)
        values = {}
        for name, value in base.items():
            if name not in _types(cls):
                raise TypeError(f"{call}() got {name!r}{hint(name, cls.names())}")
            values[name] = cls._checked(call, name, value)
        return cls(**values)

    @classmethod
    def _checked(cls, call: str, name: str, value: Any) -> Any:
        if value is None:
            return None
        wanted = _types(cls)[name]
        if name in cls.choices:
            if value not in cls.choices[name]:
                raise ValueError(f"{call}() got {name}={value!r}; allowed: {', '.join(cls.choices[name])}")
            return value
        if wanted == "bool" and not isinstance(value, bool) and value not in (0, 1):
            raise TypeError(f"{call}() got {name}={value!r}; allowed: True or False")
        if wanted == "bool":
            return bool(value)
        if wanted in ("int", "float"):
            if isinstance(value, bool) or not isinstance(value, numbers.Real):
                raise TypeError(f"{call}() got {name}={value!r}; allowed: a number")
            if wanted == "int":
                if not math.isfinite(value) or int(value) != value:
                    raise TypeError(f"{call}() got {name}={value!r}; allowed: a whole number")
                return int(value)
            if not math.isfinite(float(value)):
                raise ValueError(f"{call}() got {name}={value!r}; allowed: a finite number")
            return float(value)
        if wanted.startswith("Sequence"):
            return numbers_of(call, name, value)
        if not isinstance(value, str):
            raise TypeError(f"{call}() got {name}={value!r}; allowed: a text")
        return value

    def as_dict(self) -> dict[str, Any]:
        """The values that are not None."""
        return {name: value for name in self.names() if (value := getattr(self, name)) is not None}

    def _replaced(self: F, changes: Mapping[str, Any]) -> F:
        kept, changes = self.as_dict(), dict(changes)
        both = {**kept, **changes}
        if both.get("planes_per_bin") and changes.get("pixel_columns") is not None:
            changes["planes_per_bin"] = 0  # columns that are named decide
        elif both.get("planes_per_bin") and both.get("frustum") == "sweep":
            kept.pop("pixel_columns", None)  # they follow, and are the server's to make: sent, they would decide
        return type(self).of(kept, "replace", **changes)

    def write(self, message: M) -> M:
        """Into a protobuf message. OverflowError of a number that does not fit becomes ValueError."""
        for name, value in self.as_dict().items():
            if _types(type(self))[name].startswith("Sequence"):
                list_of = getattr(message, name)
                list_of.SetInParent()  # an empty list is one, too
                getattr(list_of, list_of.DESCRIPTOR.fields[0].name)[:] = value
                continue
            try:
                setattr(message, name, self.choices[name][value] if name in self.choices else value)
            except (ValueError, OverflowError) as error:
                raise ValueError(f"{name}={value!r} does not fit the message: {error}") from None
        return message

    @classmethod
    def read(cls: type[F], message: Message) -> F:
        """What a protobuf message has. A choice of a later version keeps its number as text."""
        values = {}
        for name in cls.names():
            if not message.HasField(name):
                continue
            value = getattr(message, name)
            if isinstance(value, Message):
                value = tuple(getattr(value, value.DESCRIPTOR.fields[0].name))
            if name in cls.choices:
                value = next((text for text, number in cls.choices[name].items() if number == value), str(value))
            values[name] = value
        return cls(**values)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in self.as_dict().items())})"


_known: dict[type[Fields], dict[str, str]] = {}


def _types(cls: type[Fields]) -> dict[str, str]:
    """Name -> "float", in the order of the fields. Made once: frames come by the hundred a second."""
    if cls not in _known:
        _known[cls] = {field.name: str(field.type).split(" ")[0] for field in dataclasses.fields(cls)}  # type: ignore[arg-type]
    return _known[cls]
