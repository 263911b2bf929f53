"""What a running obliqd says of itself: /metrics."""
import re
import urllib.request

LINE = re.compile(r"^([a-z_]+)(\{[^}]*\})? (\S+)$")
BUCKET = re.compile(r'le="([^"]+)"')


def read_metrics(address):
    """{name: sum over labels}, and {histogram: {upper bound: cumulated count}}."""
    with urllib.request.urlopen(f"http://{address}/metrics", timeout=20) as answer:
        text = answer.read().decode()
    values, buckets = {}, {}
    for line in text.splitlines():
        found = LINE.match(line)
        if not found:
            continue
        name, labels, value = found.groups()
        if name.endswith("_bucket"):
            bound = float(BUCKET.search(labels).group(1).replace("+Inf", "inf"))
            histogram = buckets.setdefault(name[: -len("_bucket")], {})
            histogram[bound] = histogram.get(bound, 0) + float(value)
        else:
            values[name] = values.get(name, 0) + float(value)
    return values, buckets


def quantile(before, after, part):
    """Of what a histogram counted between two readings, linear inside a bucket; None when it counted nothing. What is
    above the last bound counts as that bound."""
    bounds = sorted(after)
    counts = [after[bound] - before.get(bound, 0) for bound in bounds]
    if not counts or counts[-1] <= 0:
        return None
    wanted = part * counts[-1]
    low, below = 0.0, 0.0
    for bound, count in zip(bounds, counts):
        if count >= wanted:
            if bound == float("inf") or count == below:
                return low
            return low + (bound - low) * (wanted - below) / (count - below)
        low, below = bound, count
    return low
