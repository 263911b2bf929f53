"""What Settings and Pose share: values by name, checked before anything is sent."""
from __future__ import annotations

import collections.abc
import dataclasses
import difflib
import functools
import math
import numbers
import typing


def hint(name, known):
    """"; did you mean r_max_m?" where a known name is near."""
    near = difflib.get_close_matches(str(name), list(known), n=1)
    return f"; did you mean {near[0]}?" if near else f"; known are {', '.join(known)}"


def number(name, value):
    """The value, where it is a number."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name}: found {value!r}; allowed: a number")
    return value


class Fields:
    """A frozen dataclass of optional values that a protobuf message of the same field names carries."""

    choices: typing.ClassVar[dict] = {}
    keys: typing.ClassVar[dict] = {}
    ideal: typing.ClassVar[dict] = {}  # the values that an ideal map has: with another, bins are more than its echoes

    @classmethod
    @functools.cache
    def names(cls):
        return tuple(cls._types())

    @classmethod
    @functools.cache
    def _types(cls):
        """Name -> "float", in the order of the fields. Made once: frames come by the hundred a second."""
        return {field.name: field.type.split(" ")[0] for field in dataclasses.fields(cls)}

    @classmethod
    def of(cls, given=None, call=None, **more):
        """From an object of this class, a mapping, None, and keywords that override it. TypeError for a name that
        does not exist or a value of the wrong type, ValueError for an unknown choice."""
        call = call or cls.__name__
        if given is None:
            base = {}
        elif isinstance(given, cls):
            base = given.as_dict()
        elif isinstance(given, collections.abc.Mapping):
            base = dict(given)
        else:
            raise TypeError(f"{call}() got {type(given).__name__}; allowed: {cls.__name__} or a dict")
        base.update(more)
        values = {}
        for name, value in base.items():
            if name not in cls._types():
                raise TypeError(f"{call}() got {name!r}{hint(name, cls.names())}")
            values[name] = cls._checked(call, name, value)
        return cls(**values)

    @classmethod
    def _checked(cls, call, name, value):
        if value is None:
            return None
        wanted = cls._types()[name]
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
        if not isinstance(value, str):
            raise TypeError(f"{call}() got {name}={value!r}; allowed: a text")
        return value

    def as_dict(self):
        """The values that are not None."""
        return {name: value for name in self.names() if (value := getattr(self, name)) is not None}

    def replace(self, **changes):
        return type(self).of(self, "replace", **changes)

    def write(self, message):
        """Into a protobuf message. OverflowError of a number that does not fit becomes ValueError."""
        for name, value in self.as_dict().items():
            try:
                setattr(message, name, self.choices[name][value] if name in self.choices else value)
            except (ValueError, OverflowError) as error:
                raise ValueError(f"{name}={value!r} does not fit the message: {error}") from None
        return message

    @classmethod
    def read(cls, message):
        values = {}
        for name in cls.names():
            if not message.HasField(name):
                continue
            value = getattr(message, name)
            if name in cls.choices:
                # A choice of a later version keeps its number as text.
                value = next((text for text, number in cls.choices[name].items() if number == value), str(value))
            values[name] = value
        return cls(**values)

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in self.as_dict().items())})"
