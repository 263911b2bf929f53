"""Data sets for PyTorch. Needs torch, which this package does not install.

    train = obliq.torch.RadarDataset(obliq.Dataset("set").select(split="train"))
    loader = torch.utils.data.DataLoader(train, batch_size=16, shuffle=True, num_workers=4)
"""
from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import torch
from torch.utils.data import Dataset as TorchDataset

from ._sets.dataset import Dataset

__all__ = ["RadarDataset"]


class RadarDataset(TorchDataset):  # type: ignore[misc, type-arg, unused-ignore]
    """Frames by number: a dict with a tensor [azimuth, range] for each plane, and id, split and columns of meta that are
    numbers or texts. planes: some of them; transform: what becomes of the dict. Small when it is pickled: workers map the
    files themselves."""

    def __init__(self, data: Dataset | str | os.PathLike[str], planes: str | Iterable[str] | None = None,
                 transform: Callable[[dict[str, Any]], Any] | None = None):
        self.data = data if isinstance(data, Dataset) else Dataset(data)
        there = self.data.planes()
        self.planes = there if planes is None else tuple(planes.replace(",", " ").split() if isinstance(planes, str) else planes)
        for name in self.planes:
            if name not in there:
                raise ValueError(f"planes: found {name!r}; allowed: {', '.join(there)}")
        self.transform = transform

    def __len__(self) -> int:
        return len(self.data)

    def __getitem__(self, at: int) -> Any:
        arrays = self.data.arrays(at)
        sample: dict[str, Any] = {name: value for name, value in self.data.about(at).items()
                                  if isinstance(value, (str, int, float))}
        for name in self.planes:
            values = np.array(arrays[name])  # a copy: what is mapped cannot be written
            sample[name] = torch.from_numpy(values.astype(np.int64) if values.dtype == np.uint32 else values)
        return sample if self.transform is None else self.transform(sample)
