"""The sessions for given settings, and the settings that are refused."""

import json

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from zenoh_bridge.plan import plan_of
from zenoh_bridge.settings import ZenohBridgeSettings
from zenoh_bridge.wants import RemoteWants, demand_of, token_key

from vrut_lite.errors import UserError
from vrut_lite.kernel.messages import Demand

DEFAULTS = ZenohBridgeSettings()


def plan(**changes):
    return plan_of(msgspec.structs.replace(DEFAULTS, **changes))


@pytest.mark.parametrize(
    "endpoint",
    ["tcp/127.0.0.1:7447", "tcp/localhost:7447", "tcp/[::1]:1", "tcp/127.8.9.1:65535"],
)
@pytest.mark.parametrize("mode", ["listen", "connect"])
def test_only_the_endpoint_is_opened(mode, endpoint):
    """All of Zenoh's other ways to listen and to discover peers are switched off."""
    config = plan(mode=mode, endpoint=endpoint).config
    listens = mode == "listen"
    assert config["listen/endpoints"] == ([endpoint] if listens else [])
    assert config["connect/endpoints"] == ([] if listens else [endpoint])
    for way_in in (
        "scouting/multicast/enabled",
        "scouting/gossip/enabled",
        "adminspace/enabled",
        "plugins_loading/enabled",
        "transport/shared_memory/enabled",
    ):
        assert config[way_in] is False


@pytest.mark.parametrize("host", ["0.0.0.0", "[::]", "192.168.0.7", "example.org", "127.0.0.1.x"])
def test_another_machine_is_refused_unless_allowed(host):
    """A remote endpoint needs `allow_remote`."""
    with pytest.raises(UserError, match="not on this machine: set allow_remote to true"):
        plan(endpoint=f"tcp/{host}:7447")
    assert plan(endpoint=f"tcp/{host}:7447", allow_remote=True).config["mode"] == "peer"


@pytest.mark.parametrize(
    "endpoint",
    [
        "",
        "tcp/127.0.0.1",
        "udp/127.0.0.1:7447",
        "tcp/127.0.0.1:0",
        "tcp/127.0.0.1:65536",
        "tcp/127.0.0.1:7447#iface=eth0",
        "tcp/127.0.0.1:7447\n",
        "tcp/a,b:1",
        "tcp/::1:7447",
    ],
)
def test_malformed_endpoints_are_refused(endpoint):
    """Endpoints that Zenoh might parse differently from the check are refused."""
    with pytest.raises(UserError, match=r"write tcp/ADDRESS:PORT or tls/ADDRESS:PORT"):
        plan(endpoint=endpoint, allow_remote=True)


def test_tls_is_mutual_or_not_at_all(tmp_path):
    """TLS needs all three files; incomplete or unused ones are named."""
    files = {name: str(tmp_path / name) for name in ("tls_ca", "tls_certificate", "tls_key")}
    with pytest.raises(UserError, match=r"tls_ca of zenoh_bridge is set, but .* not encrypted"):
        plan(tls_ca=files["tls_ca"])
    for name, path in files.items():
        with pytest.raises(UserError, match=f"{name} of zenoh_bridge names no file"):
            plan(endpoint="tls/localhost:7447", **files)
        (tmp_path / name).touch()
        assert path.endswith(name)
    found = plan(endpoint="tls/localhost:7447", **files)
    tls = found.config["transport/link/tls"]
    assert tls["enable_mtls"] is tls["verify_name_on_connect"] is True
    assert tls["listen_private_key"] == files["tls_key"]
    assert "not encrypted" not in found.place
    assert "not encrypted" in plan().place


@pytest.mark.parametrize("prefix", ["", "/a", "a/", "a//b", "a/*", "a$b", "a?b", "a#b", "a b"])
def test_a_prefix_is_a_plain_key(prefix):
    """Wildcards in a prefix, which would match all bridges, are refused."""
    with pytest.raises(UserError, match="use words joined by slashes"):
        plan(prefix=prefix)


def test_a_configuration_is_plain_json():
    """Every value can be encoded as JSON, as Zenoh receives it."""
    assert json.loads(json.dumps(plan().config)) == plan().config


@given(st.none() | st.integers(1, 4096), st.sampled_from(["", "u8", "float16", "float32"]))
def test_a_demand_is_a_key_and_back(size, encoding):
    """A demand survives the round trip through a token's key."""
    key = token_key("a/b", "c0ffee", "BackgroundChanged", size, encoding)
    demand = demand_of(key, max_array=2**31)
    assert (demand.message, demand.size, demand.encoding) == ("BackgroundChanged", size, encoding)


@given(st.text(max_size=60))
def test_a_mangled_demand_is_refused(text):
    """Malformed keys and huge sizes are refused."""
    with pytest.raises(UserError):
        demand_of(f"vrut_lite/want/c0ffee/{text}", max_array=2**26)


@pytest.mark.parametrize("size", ["0", "-1", "4097", "9" * 5000, "٣", "1e3", " 1"])
def test_a_demand_in_an_impossible_size_is_refused(size):
    """The largest size is that of the command line."""
    with pytest.raises(UserError, match="size"):
        demand_of(f"p/want/c0ffee/BackgroundChanged/{size}/any", max_array=2**31)


@pytest.mark.parametrize(
    ("size", "encoding", "edge"), [(2048, "float32", 1024), (1365, "", 1024), (4096, "u8", 1024)]
)
def test_a_demand_for_more_than_can_cross_is_refused(size, encoding, edge):
    """A demand for a cube map that exceeds `max_array` is refused."""
    most = 6 * edge**2 * 3 * {"float32": 4, "": 2, "u8": 1}[encoding]
    with pytest.raises(UserError, match="raise max_array_mib on both sides"):
        demand_of(token_key("p", "x", "BackgroundChanged", size, encoding), most)
    assert demand_of(token_key("p", "x", "BackgroundChanged", edge, encoding), most).size == edge
    assert demand_of(token_key("p", "x", "AirChanged", size, encoding), most).size == size


def test_a_consumer_afar_has_a_name_of_bounded_length():
    """Names of consumers are stored and joined, so their length is limited."""
    demand_of(token_key("p", "x" * 64, "SunMoved", 1, ""), max_array=2**26)
    with pytest.raises(UserError, match="the name is too long"):
        demand_of(token_key("p", "x" * 65, "SunMoved", 1, ""), max_array=2**26)


def test_demands_of_many_merge_until_taken_back():
    """The largest size and best encoding count; withdrawn demands vanish; floods are refused."""
    wants, keys = RemoteWants(max_array=2**26), []
    for peer, size, encoding in (("a", 64, "float32"), ("b", 512, "")):
        keys.append(token_key("p", peer, "BackgroundChanged", size, encoding))
        assert wants.note(keys[-1], True) == "BackgroundChanged"
        assert wants.note(keys[-1], True) is None
    merged = wants.wanted("BackgroundChanged")
    assert (merged.size, merged.encoding) == (512, "float32")
    wants.note(keys[1], False)
    assert isinstance(merged, Demand)
    assert wants.wanted("BackgroundChanged").size == 64
    wants.note(keys[0], False)
    assert wants.wanted("BackgroundChanged") is None
    for number in range(1024):
        wants.note(token_key("p", str(number), "SunMoved", 1, ""), True)
    with pytest.raises(UserError, match="more than 1024 demands"):
        wants.note(token_key("p", "one more", "SunMoved", 1, ""), True)
