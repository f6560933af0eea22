"""Parses a KML file with a real XML parser and prints what a globe viewer would show of it.

    kml_check.py FILE     first line: placemarks, visible ones, lines, polygons; then one line per visible barb:
                          name, how far its staff reaches [m], from where the wind comes by it [deg]
"""

import math
import sys
import xml.etree.ElementTree as tree

KML = "{http://www.opengis.net/kml/2.2}"


def numbers(text):
    return [tuple(float(x) for x in point.split(",")) for point in text.split()]


def main():
    root = tree.parse(sys.argv[1]).getroot()
    if root.tag != KML + "kml":
        sys.exit(f"root is {root.tag}")
    styles = {style.get("id") for style in root.iter(KML + "Style")}
    marks = list(root.iter(KML + "Placemark"))
    visible = [m for m in marks if m.findtext(KML + "visibility", "1") == "1"]
    for mark in marks:
        if mark.findtext(KML + "styleUrl")[1:] not in styles:
            sys.exit(f"no style {mark.findtext(KML + 'styleUrl')}")
    for point in root.iter(KML + "coordinates"):
        for lon, lat, height in numbers(point.text):
            if not (abs(lon) <= 180 and abs(lat) <= 90 and abs(height) < 1e5):
                sys.exit(f"no place: {lon} {lat} {height}")
    print(len(marks), len(visible), len(list(root.iter(KML + "LineString"))), len(list(root.iter(KML + "Polygon"))))
    for mark in visible:
        lines = mark.findall(f"{KML}MultiGeometry/{KML}LineString")
        if not lines:
            continue
        (lon, lat, _), (far_lon, far_lat, _) = numbers(lines[0].findtext(KML + "coordinates"))[:2]
        north = (far_lat - lat) * 111195
        east = (far_lon - lon) * 111195 * math.cos(math.radians(lat))
        print(mark.findtext(KML + "name"), f"{math.hypot(north, east):.1f}",
              f"{math.degrees(math.atan2(east, north)) % 360:.1f}", sep="|")


main()
