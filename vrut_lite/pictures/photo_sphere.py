"""Photo Sphere metadata (XMP): what viewers read to show a picture all around.

Google's namespace `GPano` (developers.google.com/streetview/spherical-metadata). It has no word for
two eyes in one file: `StereoMode` is the one of Google's films, `GSpherical`, which some programs
write and read in `GPano` too.
"""

from html import escape
from typing import NamedTuple

_GPANO = "http://ns.google.com/photos/1.0/panorama/"
_GSPHERICAL = "http://ns.google.com/videos/1.0/spherical/"
_PACKET = (
    '<?xpacket begin="\ufeff" id="W5M0MpCehiHzreSzNTczkc9d"?>'
    '<x:xmpmeta xmlns:x="adobe:ns:meta/">'
    '<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
    '<rdf:Description rdf:about="" {attributes}/>'
    '</rdf:RDF></x:xmpmeta><?xpacket end="w"?>'
)


class PhotoSphere(NamedTuple):
    """An equirectangular picture of the whole sphere, level, with true north in its middle.

    Attributes:
        size_px: width and height of the file; with `stereo` both eyes, the left one on top.
        heading_deg: azimuth at which viewers begin, clockwise of true north.
        software: the program and its version.
    """

    size_px: tuple[int, int]
    stereo: bool
    heading_deg: float
    software: str

    def xmp(self) -> bytes:
        """The XMP packet, UTF-8."""
        width, height = self.size_px
        values: dict[str, object] = {
            "xmlns:GPano": _GPANO,
            "GPano:UsePanoramaViewer": True,
            "GPano:StitchingSoftware": self.software,
            "GPano:ProjectionType": "equirectangular",
            "GPano:PoseHeadingDegrees": 0.0,
            "GPano:PosePitchDegrees": 0.0,
            "GPano:PoseRollDegrees": 0.0,
            "GPano:InitialViewHeadingDegrees": round(self.heading_deg) % 360,
            "GPano:FullPanoWidthPixels": width,
            "GPano:FullPanoHeightPixels": height,
            "GPano:CroppedAreaImageWidthPixels": width,
            "GPano:CroppedAreaImageHeightPixels": height,
            "GPano:CroppedAreaLeftPixels": 0,
            "GPano:CroppedAreaTopPixels": 0,
        }
        if self.stereo:
            values["GPano:StereoMode"] = "top-bottom"
            values["xmlns:GSpherical"] = _GSPHERICAL
            values["GSpherical:ProjectionType"] = "equirectangular"
            values["GSpherical:StereoMode"] = "top-bottom"
        attributes = " ".join(f'{key}="{escape(str(value))}"' for key, value in values.items())
        return _PACKET.format(attributes=attributes).encode()
