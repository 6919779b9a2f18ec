"""Tables of TOML files for tests: within a line, and one table at its place among others."""

import json


def plain(value):
    """A value as TOML within a line."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{json.dumps(key)} = {plain(part)}' for key, part in value.items())}}}"
    return f"[{', '.join(map(plain, value))}]" if isinstance(value, list) else json.dumps(value)


def placed(around, table):
    """The tables around one, with it at the place of None."""
    if isinstance(around, dict):
        return {key: placed(part, table) for key, part in around.items()}
    return [placed(part, table) for part in around] if isinstance(around, list) else table if around is None else around


def text_of(tables):
    """A file of tables, each within a line."""
    return "".join(f"{key} = {plain(value)}\n" for key, value in tables.items())


def resolved(node, schema, kind=""):
    """A part of a JSON schema behind references and None, and of several kinds the one that is named."""
    if "$ref" in node:
        return resolved(schema["$defs"][node["$ref"].rpartition("/")[2]], schema, kind)
    choices = [resolved(one, schema, kind) for one in node.get("oneOf", node.get("anyOf", ()))]
    for one in choices:
        if one.get("properties", {}).get("kind", {}).get("const", kind) == kind and one.get("type") != "null":
            return one
    return node


def table_schema(schema, path, kind=""):
    """The schema of the table at a path such as "contact[1].node[1]"."""
    node = schema
    for step in path.replace("[1]", ".[1]").split("."):
        if step == "[1]":
            node = resolved(node["items"], schema, kind)
        else:
            inner = node.get("properties", {}).get(step) or node["additionalProperties"]
            node = resolved(inner, schema, kind)
    return node
