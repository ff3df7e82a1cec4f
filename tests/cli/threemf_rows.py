"""Rows that provoke messages of docs/errors.md: 3MF, whole and damaged (see error_cases.py)."""
import io
import struct
import zipfile

import models
from provoked import Provoked

TYPES = ('<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
         '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
         '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
RELATIONS = ('<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
             '<Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
MODEL = "3D/3dmodel.model"


def cube(number=1, kind="model", facets=models.CUBE_FACETS, of_object="", of_facet=""):
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in models.CUBE_CORNERS)
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"{of_facet}/>' for a, b, c in facets)
    return f'<object id="{number}" type="{kind}"{of_object}><mesh><vertices>{points}</vertices><triangles>{triangles}</triangles></mesh></object>'


def assembly(number, parts, transform=""):
    placed = "".join(f'<component objectid="{part}"{transform}/>' for part in parts)
    return f'<object id="{number}" type="model"><components>{placed}</components></object>'


def tower(floors, parts, transform="", base=None):
    """A cube, and assemblies upon it, each of `parts` times the one below."""
    return model((base or cube()) + "".join(assembly(n, [n - 1] * parts, transform) for n in range(2, floors + 2)), floors + 1)


def model(resources, item=1, unit="millimeter"):
    return (f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
            f'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">'
            f'<resources>{resources}</resources><build><item objectid="{item}"/></build></model>')


def archive(text, method=zipfile.ZIP_DEFLATED, more=(), name=MODEL):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", method) as files:
        for member, content in (("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS), (name, text), *more):
            files.writestr(member, content)
    return data.getvalue()


GOOD = archive(model(cube()))
# Where fields stand: in the end record, and in the directory's entry of the model.
END, ENTRY = GOOD.rindex(b"PK\5\6"), GOOD.rindex(b"PK\1\2")


def patched(at, layout, *values):
    data = bytearray(GOOD)
    struct.pack_into("<" + layout, data, at, *values)
    return bytes(data)


def broken_stream():
    """The first block of the model's data is of the type that deflate does not have."""
    start = GOOD.rindex(b"PK\3\4")
    data = bytearray(GOOD)
    data[start + 30 + len(MODEL)] = 7
    return bytes(data)


def threemf(message, data, code=3, command="check m.3mf", **more):
    return Provoked(message, command, code, {"m.3mf": data, **more})


COLORS = '<m:colorgroup id="5"><m:color color="#FF0000"/><m:color color="#00FF00"/></m:colorgroup>'
TEXTURE = ('<m:texture2d id="6" path="/3D/Textures/t.png" contenttype="image/png"/><m:texture2dgroup id="5" texid="6">'
           '<m:tex2coord u="0" v="0"/><m:tex2coord u="1" v="0"/><m:tex2coord u="0" v="1"/></m:texture2dgroup>')
TEXTURE_FILES = [("3D/Textures/t.png", b"\x89PNG\r\n\x1a\n"), ("3D/_rels/3dmodel.model.rels", RELATIONS.replace("/3D/3dmodel.model", "/3D/Textures/t.png").replace(
    "2013/01/3dmodel", "2013/01/3dtexture"))]

ROWS = [
    threemf("expected a ZIP archive, as every 3MF is, found {}", b"3D model\n"),
    threemf("is a ZIP archive, and no 3MF: there is no file '.model' in it", archive("x", name="part.stl")),
    threemf("is a ZIP archive without its directory, which stands at the end", GOOD[:len(GOOD) // 2]),
    threemf("is a ZIP archive with a broken directory", patched(END + 16, "I", 7)),
    threemf("is a ZIP archive with a broken directory", patched(ENTRY + 28, "H", 60000)),
    threemf("is a ZIP64 archive with a broken directory", patched(END + 10, "H", 0xffff)),
    threemf("is a ZIP archive whose file {} is not where the directory says", patched(ENTRY + 42, "I", 1)),
    threemf("is a ZIP archive whose file {} is cut off", patched(ENTRY + 20, "I", 10**6)),
    threemf("is a ZIP archive whose file {} is encrypted", patched(ENTRY + 8, "H", 1)),
    threemf("is a ZIP archive whose file {} is packed by method {}", archive(model(cube()), zipfile.ZIP_BZIP2)),
    threemf("is a ZIP archive whose file {} cannot be unpacked", broken_stream()),
    threemf("is a ZIP archive whose file {} unpacks to {} bytes, where the directory says {}", patched(ENTRY + 24, "I", 9)),
    threemf("is a ZIP archive of {} bytes that unpacks to more than {} bytes: more than any model does", archive(model(cube()), more=[("a.txt", bytes(65 << 20))])),
    threemf("cannot be read as 3MF: {} (lib3mf, 0x{})", archive(model(cube()).replace("</triangles>", ""))),
    threemf("places more than {} facets: components refer to each other too often", archive(tower(18, 2, base=cube(facets=list(models.CUBE_FACETS) * 30)))),
    threemf("places more than {} objects: components refer to each other too often", archive(tower(24, 2))),
    threemf("needs an extension of 3MF that is not known here: what it holds may be incomplete without",
            archive(model(cube()).replace("<model ", '<model xmlns:q="http://unheard.of/2026" requiredextensions="q" '))),
    threemf("has components in components more than {} deep", archive(tower(70, 1))),
    threemf("places points at coordinates that are not finite", archive(tower(12, 1, ' transform="1e38 0 0 0 1e38 0 0 0 1e38 0 0 0"'))),
    threemf("{} (lib3mf, 0x{})", archive(model(cube() + "<unheard-of/>")), 0),
    threemf("objects of type '{}' left out: only 'model' is the part itself", archive(model(cube(kind="support") + cube(2) + assembly(3, [1, 2]), 3)), 0),
    threemf("colours that change within a facet: that of its first corner is taken", archive(model(COLORS + cube(of_facet=' pid="5" p1="0" p2="1" p3="0"'))), 0),
    threemf("textures and mixed materials are left out", archive(model(TEXTURE + cube(of_facet=' pid="5" p1="0" p2="1" p3="2"')), more=TEXTURE_FILES), 0),
    threemf("its unit is {}, that of A is {}: coordinates are compared as they are", GOOD, 0, "compare m.3mf n.3mf", **{"n.3mf": archive(model(cube(), unit="inch"))}),
    threemf("the file says that its unit is {}, --units says {}: the latter was believed, and no coordinate is changed", GOOD, 0, "check m.3mf --units in"),
    Provoked("{}: the point ({}, {}, {}) is beyond the 1e9 that readers of 3MF take", "m.obj -o x.3mf --method local", 4,
             {"m.obj": models.write_obj([tuple(tuple(c * 2e9 for c in p) for p in f) for f in models.cube()])}),
    Provoked("{}: no facet is left when coordinates are rounded to float32", "m.obj -o x.3mf --method local", 4,
             {"m.obj": models.write_obj([tuple(tuple(c * 1e-47 for c in p) for p in f) for f in models.cube()])}),
]
