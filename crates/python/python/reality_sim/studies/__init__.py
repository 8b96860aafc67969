"""Studies of many recordings: one function for one recording, tables, and what the engines that others have need to run it.

>>> from reality_sim import studies
>>> row = studies.study("walk", {"job": "tag"})  # a pyarrow.RecordBatch with one row
>>> worker = studies.StudyWorker([{"job": "tag"}, {"job": "gap"}], tables="tables")
>>> worker.study_one("walk")  # writes one Parquet file for each of the settings
>>> studies.read_tables("tables")  # a pyarrow.Table, sorted by its keys
"""

from .rows import SCHEMA, key_of
from .recordings import fetched, hash_of
from .study import study
from .tables import missing_keys, read_tables, write_row
from .worker import StudyWorker

__all__ = ["SCHEMA", "StudyWorker", "fetched", "hash_of", "key_of", "missing_keys", "read_tables", "study", "write_row"]
