"""A small house as IFC text: a wall with an opening, a window in it, a storey and a site."""

_HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('house.ifc','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('{schema}'));
ENDSEC;
DATA;
"""
_SITE_PLACE = "(48,8,24,360000),(11,34,12)"


def _box(number: int, corner: str, size: tuple[float, float, float]) -> str:
    """Instances from `number`, a box of a size from a corner; number + 4 is its solid."""
    x, y, z = size
    return f"""#{number}=IFCCARTESIANPOINT(({x / 2},{y / 2}));
#{number + 1}=IFCAXIS2PLACEMENT2D(#{number},$);
#{number + 2}=IFCRECTANGLEPROFILEDEF(.AREA.,$,#{number + 1},{float(x)},{float(y)});
#{number + 5}=IFCCARTESIANPOINT({corner});
#{number + 3}=IFCAXIS2PLACEMENT3D(#{number + 5},$,$);
#{number + 4}=IFCEXTRUDEDAREASOLID(#{number + 2},#{number + 3},#7,{float(z)});
"""


def _product(number: int, kind: str, name: str, solids: str, after: str) -> str:
    """Instances from `number`, a product of some solids at the origin; the last is number + 2."""
    return f"""#{number}=IFCSHAPEREPRESENTATION(#11,'Body','SweptSolid',({solids}));
#{number + 1}=IFCPRODUCTDEFINITIONSHAPE($,$,(#{number}));
#{number + 2}={kind}('{number:022d}',$,'{name}',$,$,#9,#{number + 1},$){after};
"""


def house_ifc(
    schema: str = "IFC4",
    *,
    unit: str = ".MILLI.",
    site_place: str = _SITE_PLACE,
    elevation: str = "520000.",
    north: str = "(0.5,0.8660254037844386)",
    pane_style: str = "",
    scale: float = 1000.0,
    east_north: tuple[float, float] = (0.0, 0.0),
) -> bytes:
    """A wall of 4 x 0.3 x 3 m along x, with a hole of 2 x 1.5 m, a frame and a pane.

    Lengths are `scale` times metres. `pane_style` is an IfcSurfaceStyle's element, or empty for
    none. The wall is coloured (0.5, 0.25, 0).
    """
    s = scale
    enums = ",$" if schema != "IFC2X3" else ""
    styles = "#60=IFCCOLOURRGB($,0.5,0.25,0.);\n"
    styles += "#61=IFCSURFACESTYLERENDERING(#60,0.,$,$,$,$,$,$,.FLAT.);\n"
    styles += "#62=IFCSURFACESTYLE('plaster',.BOTH.,(#61));\n"
    if schema == "IFC2X3":
        styles += "#63=IFCPRESENTATIONSTYLEASSIGNMENT((#62));\n#64=IFCSTYLEDITEM(#24,(#63),$);\n"
    else:
        styles += "#64=IFCSTYLEDITEM(#24,(#62),$);\n"
    if pane_style:
        styles += "#65=IFCCOLOURRGB($,0.,1.,0.);\n"
        styles += f"#66={pane_style};\n#67=IFCSURFACESTYLE('F1',.BOTH.,(#66));\n"
        if schema == "IFC2X3":
            styles += "#68=IFCPRESENTATIONSTYLEASSIGNMENT((#67));\n"
            styles += "#69=IFCSTYLEDITEM(#44,(#68),$);\n"
        else:
            styles += "#69=IFCSTYLEDITEM(#44,(#67),$);\n"
    body = f"""#1=IFCSIUNIT(*,.LENGTHUNIT.,{unit},.METRE.);
#2=IFCUNITASSIGNMENT((#1));
#3=IFCDIRECTION({north});
#4=IFCCARTESIANPOINT((0.,0.,0.));
#5=IFCAXIS2PLACEMENT3D(#4,$,$);
#6=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#5,#3);
#7=IFCDIRECTION((0.,0.,1.));
#8=IFCCARTESIANPOINT(({east_north[0]},{east_north[1]},0.));
#10=IFCAXIS2PLACEMENT3D(#8,$,$);
#9=IFCLOCALPLACEMENT($,#10);
#11=IFCGEOMETRICREPRESENTATIONSUBCONTEXT('Body','Model',*,*,*,*,#6,$,.MODEL_VIEW.,$);
#12=IFCPROJECT('0000000000000000000012',$,'P (a; b)',$,$,$,$,(#6),#2);
#13=IFCSITE('0000000000000000000013',$,'It''s; a site',$,$,#9,$,$,.ELEMENT.,
{site_place},{elevation},$,$);
#14=IFCBUILDINGSTOREY('0000000000000000000014',$,'Ground',$,$,#9,$,$,.ELEMENT.,0.);
#15=IFCRELAGGREGATES('0000000000000000000015',$,$,$,#12,(#13));
#16=IFCRELAGGREGATES('0000000000000000000016',$,$,$,#13,(#14));
{_box(20, "(0.,0.,0.)", (4 * s, 0.3 * s, 3 * s))}{_product(26, "IFCWALL", "Wall", "#24", enums)}
{_box(30, f"({s},{-s},{s})", (2 * s, 3 * s, 1.5 * s))}
{_product(36, "IFCOPENINGELEMENT", "Hole", "#34", enums)}
{_box(40, f"({1.1 * s},{0.14 * s},{1.1 * s})", (1.8 * s, 0.02 * s, 1.3 * s))}
{_box(50, f"({s},{0.1 * s},{s})", (2 * s, 0.1 * s, 0.1 * s))}
{_product(46, "IFCWINDOW", "Window", "#44,#54", ",$,$" + (",$,$,$" if enums else ""))}
#70=IFCRELVOIDSELEMENT('0000000000000000000070',$,$,$,#28,#38);
#71=IFCRELFILLSELEMENT('0000000000000000000071',$,$,$,#38,#48);
#72=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000072',$,$,$,(#28,#48),#14);
{_box(80, "(0.,0.,0.)", (9 * s, 9 * s, 9 * s))}
#86=IFCSHAPEREPRESENTATION(#11,'Body','SweptSolid',(#84));
#87=IFCPRODUCTDEFINITIONSHAPE($,$,(#86));
#88=IFCSPACE('0000000000000000000088',$,'Room',$,$,#9,#87,$,.ELEMENT.,.INTERNAL.,$);
{styles}"""
    text = _HEAD.format(schema=schema) + body + "ENDSEC;\nEND-ISO-10303-21;\n"
    return text.encode()
