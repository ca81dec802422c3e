"""Seed roc-validator's HTTP cache, so that it judges a crate without any network.

usage: seed_roc_cache.py CACHE WHEEL-1.1 WHEEL-1.3

The validator resolves the JSON-LD contexts https://w3id.org/ro/crate/1.1/context and 1.3. The wheels rocrate 0.13.0 and
0.16.0 (Apache-2.0) ship those very documents; this puts them into the cache that `rocrate-validator validate --offline
--cache-path CACHE` reads (CACHE gets the suffix .sqlite).
"""

import io
import sys
import zipfile

import requests
from requests.adapters import BaseAdapter
from requests_cache import CachedSession
from urllib3 import HTTPResponse

CONTEXTS = ("https://w3id.org/ro/crate/1.1/context", "https://w3id.org/ro/crate/1.3/context")
IN_WHEEL = "rocrate/data/ro-crate.jsonld"


class Shelf(BaseAdapter):
    """Answers every request with one document."""

    def __init__(self, document):
        super().__init__()
        self.document = document

    def send(self, request, **_):
        response = requests.Response()
        response.status_code, response.reason = 200, "OK"
        response.url, response.request = request.url, request
        response.headers["Content-Type"] = "application/ld+json"
        response.raw = HTTPResponse(
            body=io.BytesIO(self.document),
            status=200,
            headers=dict(response.headers),
            preload_content=False,
            request_url=request.url,
        )
        return response

    def close(self):
        pass


def main():
    cache, *wheels = sys.argv[1:]
    session = CachedSession(
        cache_name=cache, backend="sqlite", expire_after=-1, allowable_methods=("GET",)
    )
    # The cache's key covers this header; it is the one that rdflib sends.
    accept = {"Accept": "application/ld+json, application/json"}
    for context, wheel in zip(CONTEXTS, wheels, strict=True):
        session.mount("https://", Shelf(zipfile.ZipFile(wheel).read(IN_WHEEL)))
        terms = session.get(context, headers=accept).json()["@context"]
        print(f"seeded {context}: {len(terms)} terms")


main()
