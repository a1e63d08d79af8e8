"""The settings of the bridge."""

from typing import Annotated, Literal

import msgspec

from vrut_lite.kernel.settings import setting
from vrut_lite.message_codec import ARRAY_BYTES, MESSAGE_BYTES
from zenoh_bridge.shareable import SLOT_PRODUCTS

_KEY_FILES = "Certificates and keys (*.pem *.crt *.cer *.key);;All files (*)"
_PRODUCTS = ", ".join(kind.__name__ for kind in SLOT_PRODUCTS)


class ZenohBridgeSettings(msgspec.Struct, frozen=True):
    """The settings of the module; a change while it is enabled opens a new session."""

    enabled: Annotated[bool, setting("Join another process")] = False
    mode: Annotated[
        Literal["listen", "connect"], setting("One process listens, the others connect to it")
    ] = "listen"
    endpoint: Annotated[str, setting("Where: tcp/ADDRESS:PORT, or tls/ADDRESS:PORT")] = (
        "tcp/127.0.0.1:7447"
    )
    allow_remote: Annotated[bool, setting("Accept an endpoint on other machines than this one")] = (
        False
    )
    prefix: Annotated[str, setting("First part of all keys: bridges of one prefix meet")] = (
        "vrut_lite"
    )
    tls_ca: Annotated[
        str,
        setting(
            "File with the certificate that signed both sides' own",
            label="Signer's certificate",
            file_kinds=_KEY_FILES,
        ),
    ] = ""
    tls_certificate: Annotated[
        str,
        setting(
            "File with this side's certificate", label="Own certificate", file_kinds=_KEY_FILES
        ),
    ] = ""
    tls_key: Annotated[
        str,
        setting("File with this side's private key", label="Own key", file_kinds=_KEY_FILES),
    ] = ""
    share: Annotated[str, setting("Message types that go out, separated by commas")] = _PRODUCTS
    accept: Annotated[str, setting("Message types that may come in, separated by commas")] = (
        _PRODUCTS
    )
    max_message_kib: Annotated[
        int,
        setting(
            "Largest message to take, without its arrays",
            1,
            MESSAGE_BYTES // 1024,
            unit="KiB",
            label="Largest message",
        ),
    ] = 64
    max_array_mib: Annotated[
        int,
        setting(
            "Largest array to take", 1, ARRAY_BYTES // 2**20, unit="MiB", label="Largest array"
        ),
    ] = 64
