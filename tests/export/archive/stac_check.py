"""Holds every JSON file of an archive's STAC catalogue to a schema, and follows every link.

    stac_check.py ARCHIVE     prints one line per fault; exit code 1 when there is one

The schema below is ours, written from the rules of the STAC specification 1.0.0 (item, catalogue, collection and link
fields, GeoJSON geometry) and of its extensions version, file and processing, as far as an archive uses them.
"""

import json
import pathlib
import sys

import jsonschema

TIME = {"type": "string", "pattern": r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z$"}
TIME_OR_NULL = {"anyOf": [TIME, {"type": "null"}]}
TEXT = {"type": "string", "minLength": 1}
LINK = {"type": "object", "required": ["rel", "href"],
        "properties": {"rel": TEXT, "href": TEXT, "type": TEXT, "title": {"type": "string"}}}
LINKS = {"type": "array", "items": LINK}
BOX = {"type": "array", "items": {"type": "number"}, "oneOf": [{"minItems": 4, "maxItems": 4},
                                                              {"minItems": 6, "maxItems": 6}]}
COMMON = {"stac_version": {"const": "1.0.0"}, "id": TEXT, "links": LINKS,
          "stac_extensions": {"type": "array", "uniqueItems": True, "items": {"type": "string", "format": "uri"}}}
CATALOG = {"type": "object", "required": ["type", "stac_version", "id", "description", "links"],
           "properties": {**COMMON, "type": {"const": "Catalog"}, "description": TEXT, "title": {"type": "string"}}}
COLLECTION = {"type": "object",
              "required": ["type", "stac_version", "id", "description", "license", "extent", "links"],
              "properties": {**COMMON, "type": {"const": "Collection"}, "description": TEXT,
                             "license": {"type": "string", "pattern": r"^[\w\-\.\+]+$"},
                             "keywords": {"type": "array", "items": TEXT},
                             "extent": {"type": "object", "required": ["spatial", "temporal"], "properties": {
                                 "spatial": {"type": "object", "required": ["bbox"], "properties": {
                                     "bbox": {"type": "array", "minItems": 1, "items": BOX}}},
                                 "temporal": {"type": "object", "required": ["interval"], "properties": {
                                     "interval": {"type": "array", "minItems": 1, "items": {
                                         "type": "array", "minItems": 2, "maxItems": 2, "items": TIME_OR_NULL}}}}}}}}
ASSET = {"type": "object", "required": ["href"],
         "properties": {"href": TEXT, "type": TEXT, "title": {"type": "string"},
                        "roles": {"type": "array", "items": TEXT},
                        "file:size": {"type": "integer", "minimum": 1},
                        "file:checksum": {"type": "string", "pattern": "^1220[a-f0-9]{64}$"}}}
PROPERTIES = {"type": "object", "required": ["datetime", "version", "deprecated"],
              "properties": {"datetime": TIME, "start_datetime": TIME, "end_datetime": TIME, "created": TIME,
                             "updated": TIME, "platform": {"type": "string"}, "version": TEXT,
                             "instruments": {"type": "array", "items": TEXT}, "deprecated": {"type": "boolean"},
                             "license": {"type": "string", "pattern": r"^[\w\-\.\+]+$"},
                             "processing:level": TEXT,
                             "processing:software": {"type": "object", "additionalProperties": {"type": "string"}}},
              "dependentRequired": {"start_datetime": ["end_datetime"], "end_datetime": ["start_datetime"]}}
ITEM = {"type": "object",
        "required": ["type", "stac_version", "id", "geometry", "bbox", "properties", "links", "assets", "collection"],
        "properties": {**COMMON, "type": {"const": "Feature"}, "bbox": BOX, "collection": TEXT,
                       "properties": PROPERTIES, "assets": {"type": "object", "additionalProperties": ASSET},
                       "geometry": {"type": "object", "required": ["type", "coordinates"], "properties": {
                           "type": {"const": "Point"},
                           "coordinates": {"type": "array", "minItems": 2, "maxItems": 3, "prefixItems": [
                               {"type": "number", "minimum": -180, "maximum": 180},
                               {"type": "number", "minimum": -90, "maximum": 90}]}}}}}
SCHEMAS = {"Catalog": CATALOG, "Collection": COLLECTION, "Feature": ITEM}


def faults_of(path, root):
    thing = json.loads(path.read_text(encoding="utf-8"))
    schema = SCHEMAS.get(thing.get("type"))
    if schema is None:
        return [f"{path}: is no catalogue, collection or item"], thing
    found = [f"{path}: {error.json_path}: {error.message}"
             for error in jsonschema.Draft202012Validator(schema).iter_errors(thing)]
    hrefs = [link["href"] for link in thing["links"]] + [a["href"] for a in thing.get("assets", {}).values()]
    for href in hrefs:
        target = (path.parent / href).resolve()
        if not target.is_file() or root not in target.parents:
            found.append(f"{path}: {href} leads nowhere")
    if thing["type"] == "Feature" and not any(link["rel"] == "collection" for link in thing["links"]):
        found.append(f"{path}: an item of a collection links it")
    return found, thing


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    faults, seen, todo = [], set(), [root / "catalog.json"]
    while todo:
        path = todo.pop()
        if path in seen:
            continue
        seen.add(path)
        if not path.is_file():
            continue  # told by who links it
        found, thing = faults_of(path, root)
        faults += found
        todo += [(path.parent / link["href"]).resolve() for link in thing.get("links", [])
                 if link.get("rel") in ("child", "item")]
    items = {path for path in root.glob("profiles/*/*/*/*/*.json") if path.name != "manifest.json"}
    faults += [f"{path}: no link leads here" for path in sorted(items - seen)]
    print("\n".join(faults))
    sys.exit(1 if faults or not items else 0)


if __name__ == "__main__":
    main()
