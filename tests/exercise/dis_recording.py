"""The PDUs of an exercise as opendis encodes them, for tests/exercise/dis_load.py: a round of all entities after the other.

  dis_recording.py OUT.bin    needs opendis and what it needs, nothing of the project
"""
import io
import math
import pathlib
import random
import sys

from opendis.DataOutputStream import DataOutputStream
from opendis.RangeCoordinates import GPS
from opendis.dis7 import EntityStatePdu

ENTITIES = 1000
ROUNDS_HZ, ROUNDS = 10, 40  # those that move go round in 4 s
EXERCISE, SITE, APPLICATION = 7, 11, 22
TYPES = ((1, 1, 225, 7), (1, 1, 225, 81), (1, 2, 225, 1), (1, 3, 225, 61))  # a truck, a car, an aircraft, a ship
LATITUDE_DEG, LONGITUDE_DEG, SPREAD_DEG = 33.0, -99.5, 0.1
STANDS, FPW = 1, 2  # dead reckoning: not at all, by the velocity


def encoded(number, kind, place, velocity, algorithm):
    """The bytes of an Entity State PDU; place and velocity in the earth's axes, metres."""
    pdu = EntityStatePdu()
    pdu.pduType, pdu.protocolFamily, pdu.exerciseID = 1, 1, EXERCISE
    pdu.pduStatus = pdu.entityAppearance = pdu.capabilities = 0  # opendis 1.0 has no numbers there
    pdu.entityID.siteID, pdu.entityID.applicationID, pdu.entityID.entityID = SITE, APPLICATION, number
    pdu.entityType.entityKind, pdu.entityType.domain, pdu.entityType.country, pdu.entityType.category = kind
    for vector, values in ((pdu.entityLocation, place), (pdu.entityLinearVelocity, velocity)):
        vector.x, vector.y, vector.z = values
    pdu.deadReckoningParameters.deadReckoningAlgorithm = algorithm
    pdu.marking.characterSet = 1
    pdu.marking.setString(f"E{number}")
    stream = io.BytesIO()
    pdu.serialize(DataOutputStream(stream))
    data = bytearray(stream.getvalue())
    data[8:10] = len(data).to_bytes(2, "big")  # opendis leaves it 0
    return bytes(data)


def rounds_of(number, draw):
    """A list of its PDUs: every other entity stands, the others go round a circle."""
    kind, phase = TYPES[number % len(TYPES)], draw.uniform(0, 2 * math.pi)
    latitude, longitude = (math.radians(middle + draw.uniform(-SPREAD_DEG, SPREAD_DEG)) for middle in (LATITUDE_DEG, LONGITUDE_DEG))
    centre = GPS().llarpy2ecef(latitude, longitude, draw.uniform(300, 3000), 0.0, 0.0, 0.0)[:3]
    if number % 2:
        return [encoded(number, kind, centre, (0.0, 0.0, 0.0), STANDS)] * ROUNDS
    radius_m = draw.uniform(5, 100)
    turn_rad_s = 2 * math.pi * ROUNDS_HZ / ROUNDS
    east = (-math.sin(longitude), math.cos(longitude), 0.0)
    north = (-math.sin(latitude) * math.cos(longitude), -math.sin(latitude) * math.sin(longitude), math.cos(latitude))
    made = []
    for k in range(ROUNDS):
        angle = phase + turn_rad_s * k / ROUNDS_HZ
        c, s = radius_m * math.cos(angle), radius_m * math.sin(angle)
        place = [at + c * e + s * n for at, e, n in zip(centre, east, north)]
        made.append(encoded(number, kind, place, [turn_rad_s * (c * n - s * e) for e, n in zip(east, north)], FPW))
    return made


def main(out):
    draw = random.Random(7)
    entities = [rounds_of(number, draw) for number in range(1, ENTITIES + 1)]
    out.write_bytes(b"".join(entity[k] for k in range(ROUNDS) for entity in entities))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1])) if len(sys.argv) == 2 else sys.exit(__doc__)
