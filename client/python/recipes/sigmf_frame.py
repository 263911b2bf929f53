"""A frame's I&Q as SigMF: sigmf_frame.py FRAME.npz OUT writes OUT.sigmf-data and OUT.sigmf-meta. Needs pip install sigmf.

Samples are those of the azimuth bins one after the other, each a row of range bins; an annotation names each row.
"""
import pathlib
import sys

import obliq
import sigmf
from sigmf import SigMFFile


def main(source, out):
    frame = obliq.load(source)
    frame.iq.tofile(out + ".sigmf-data")
    # 1 / the time between range bins, two-way: c / (2 spacing).
    rate_hz = 299792458.0 / (2 * frame.descriptor.range_spacing_m)
    meta = SigMFFile(data_file=out + ".sigmf-data", global_info={
        SigMFFile.DATATYPE_KEY: "cf32_le", SigMFFile.SAMPLE_RATE_KEY: rate_hz, SigMFFile.VERSION_KEY: sigmf.__specification__,
        SigMFFile.DESCRIPTION_KEY: f"obliq, radar {frame.radar}: {frame.shape[0]} azimuth bins of {frame.shape[1]} range bins"})
    meta.add_capture(0, metadata={SigMFFile.FREQUENCY_KEY: frame.settings.frequency_ghz * 1e9,
                                  SigMFFile.DATETIME_KEY: str(frame.utc.astype("datetime64[us]")) + "Z"})
    for row, azimuth in enumerate(frame.azimuth_deg):
        meta.add_annotation(row * frame.shape[1], frame.shape[1], metadata={SigMFFile.LABEL_KEY: f"{azimuth % 360:.3f} deg"})
    meta.validate()
    pathlib.Path(out + ".sigmf-meta").unlink(missing_ok=True)  # tofile() overwrites nothing
    meta.tofile(out + ".sigmf-meta")


if __name__ == "__main__":
    main(*sys.argv[1:])
