"""Rows of the tables: what every study says of a recording, in the same columns whatever was studied."""

from __future__ import annotations

from typing import Any

import pyarrow as pa

__all__ = ["FIGURES", "KEY", "SCHEMA", "batch_of", "key_of"]

#: Columns by which a row is found: nothing else decides what is in it.
KEY = ("recording", "settings", "version")

_METHODS = ("nearest", "quadratic", "plane", "blend", "simulated")
_CHANNELS = ("geometry", "photometry", "sharpness", "color", "noise", "motion")

#: Numbers that studies find. A column is null where a study does not tell it.
FIGURES = (
    # Poses, by `tag`.
    "frames",
    "lines_within_5px",
    "lines_within_10px",
    "completeness",
    "settled",
    "sure",
    "mean_m",
    "median_m",
    "rmse_m",
    "p95_m",
    "max_m",
    "mean_yaw_rad",
    "lost_frames",
    # The camera, by `gap`.
    "gap_before",
    "gap_after",
    "effects",
    "unexplained",
    *(f"gap_{channel}_{which}" for channel in _CHANNELS for which in ("before", "after")),
    # Pictures, by `evaluate`.
    "probes",
    "images",
    *(f"{method}_{figure}" for method in _METHODS for figure in ("psnr_db", "psnr_field_db", "ssim", "answered")),
    # Pictures that were made, by `dataset`.
    "pictures",
    "annotations",
)

#: Columns of every table.
SCHEMA = pa.schema(
    [
        # Hashes, and the version of the library with that of its sources.
        pa.field("recording", pa.string()),
        pa.field("settings", pa.string()),
        pa.field("version", pa.string()),
        # Why nothing was found.
        pa.field("error", pa.string()),
        pa.field("job", pa.string()),
        # Settings in words, with their default values.
        pa.field("settings_json", pa.string()),
        # What the recording says of itself.
        pa.field("name", pa.string()),
        pa.field("robot", pa.string()),
        pa.field("day", pa.string()),
        *(pa.field(figure, pa.float64()) for figure in FIGURES),
        # Everything else, in JSON.
        pa.field("report", pa.string()),
        # The picture that says the most, a small JPEG file.
        pa.field("picture", pa.binary()),
    ]
)


def key_of(row: dict[str, Any]) -> str:
    """Returns the key of a row, as the name of its file has it."""
    recording, settings, version = (row[column] for column in KEY)
    return f"{recording}-{settings}-{version}"


def batch_of(rows: list[dict[str, Any]]) -> pa.RecordBatch:
    """Makes a batch of rows; what a row does not tell is null.

    Raises:
      KeyError: for something that the tables have no column for.
    """
    for row in rows:
        unknown = sorted(row.keys() - set(SCHEMA.names))
        if unknown:
            raise KeyError(f"the tables have no column {unknown[0]}")
    return pa.RecordBatch.from_pylist(rows, schema=SCHEMA)
