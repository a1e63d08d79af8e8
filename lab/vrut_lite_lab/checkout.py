"""The checkout that the laboratory is installed from: it reads its scenes and writes its data."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
