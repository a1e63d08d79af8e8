"""Checks the settings and turns them into the configuration of a Zenoh session."""

import ipaddress
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Derived
from zenoh_bridge.settings import ZenohBridgeSettings
from zenoh_bridge.shareable import types_named

_ENDPOINT = re.compile(r"(tcp|tls)/(?:\[([0-9a-fA-F:]+)\]|([\w.-]+)):(\d{1,5})")
_PREFIX = re.compile(r"\w[\w-]*(/\w[\w-]*)*")
# A frame's envelope, in bytes, beyond the array that it carries.
_ENVELOPE = 2**16
# The previous session may hold the endpoint for this long.
_LISTEN_TIMEOUT_MS = 2000


@dataclass(frozen=True)
class SessionPlan:
    """A session to open: keys below `prefix`, sizes in bytes, and Zenoh's configuration."""

    prefix: str
    share: tuple[type[Derived], ...]
    accept: tuple[type[Derived], ...]
    max_message: int
    max_array: int
    place: str
    config: dict[str, Any]


def plan_of(settings: ZenohBridgeSettings) -> SessionPlan:
    """The session for these settings.

    Raises:
        UserError: the endpoint is malformed or not allowed, TLS is incomplete, a message type
            cannot cross, or the prefix is not a key.
    """
    protocol = _check_endpoint(settings)
    if not _PREFIX.fullmatch(settings.prefix):
        raise UserError(
            f"prefix of zenoh_bridge is {settings.prefix!r}: use words joined by slashes"
        )
    max_array = settings.max_array_mib * 2**20
    secured = "" if protocol == "tls" else ", not encrypted"
    verb = "listening on" if settings.mode == "listen" else "connecting to"
    return SessionPlan(
        prefix=settings.prefix,
        share=types_named(settings.share, "share"),
        accept=types_named(settings.accept, "accept"),
        max_message=settings.max_message_kib * 1024,
        max_array=max_array,
        place=f"{verb} {settings.endpoint}{secured}",
        config=_config(settings, protocol, max_array + _ENVELOPE),
    )


def _check_endpoint(settings: ZenohBridgeSettings) -> str:
    """The endpoint's protocol; UserError if the endpoint is not allowed."""
    found = _ENDPOINT.fullmatch(settings.endpoint)
    if found is None or not 0 < int(found[4]) < 2**16:
        raise UserError(
            f"endpoint of zenoh_bridge is {settings.endpoint!r}: "
            "write tcp/ADDRESS:PORT or tls/ADDRESS:PORT"
        )
    host = found[2] or found[3]
    if not settings.allow_remote and not _is_loopback(host):
        raise UserError(
            f"endpoint of zenoh_bridge is on {host}, not on this machine: "
            "set allow_remote to true if that is meant"
        )
    _check_tls(settings, found[1])
    return found[1]


def _check_tls(settings: ZenohBridgeSettings, protocol: str) -> None:
    files = {name: getattr(settings, name) for name in ("tls_ca", "tls_certificate", "tls_key")}
    given = [name for name, path in files.items() if path]
    if protocol == "tcp" and given:
        raise UserError(
            f"{given[0]} of zenoh_bridge is set, but its endpoint is not encrypted: "
            "write tls/ADDRESS:PORT"
        )
    if protocol == "tls":
        for name, path in files.items():
            if not Path(path).is_file():
                raise UserError(f"{name} of zenoh_bridge names no file: TLS needs {path!r}")


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _config(settings: ZenohBridgeSettings, protocol: str, max_size: int) -> dict[str, Any]:
    """Zenoh's configuration: this one endpoint and no other.

    Multicast, gossip, plugins and shared memory are off.
    """
    listens = settings.mode == "listen"
    config: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": [settings.endpoint] if listens else [],
        "listen/exit_on_failure": True,
        "listen/timeout_ms": _LISTEN_TIMEOUT_MS,
        "listen/retry": {
            "period_init_ms": 50,
            "period_max_ms": 200,
            "period_increase_factor": 2,
        },
        "connect/endpoints": [] if listens else [settings.endpoint],
        "connect/exit_on_failure": False,
        "connect/timeout_ms": -1,
        "connect/retry": {
            "period_init_ms": 200,
            "period_max_ms": 2000,
            "period_increase_factor": 2,
        },
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "adminspace/enabled": False,
        "plugins_loading/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/link/protocols": [protocol],
        "transport/link/rx/max_message_size": max_size,
    }
    if protocol == "tls":
        side = "listen" if listens else "connect"
        config["transport/link/tls"] = {
            "enable_mtls": True,
            "verify_name_on_connect": True,
            "root_ca_certificate": settings.tls_ca,
            f"{side}_certificate": settings.tls_certificate,
            f"{side}_private_key": settings.tls_key,
        }
    return config
