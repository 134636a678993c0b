"""The JSON schema of a case."""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from fiberbend.case.case import Case
from fiberbend.schema.descriptions import descriptions


class _Schema(GenerateJsonSchema):
    """Writes defaults as a case would: with their unit."""

    def default_schema(self, schema: Any) -> Any:
        result = super().default_schema(schema)
        inner = schema["schema"]
        while "serialization" not in inner and isinstance(inner.get("schema"), dict):
            inner = inner["schema"]
        write = inner.get("serialization", {}).get("function")
        if write and isinstance(result.get("default"), float):
            result["default"] = write(result["default"])
        if result.get("default", 0) is None:
            del result["default"]
        return result

    def model_schema(self, schema: Any) -> Any:
        """With the text of every field."""
        result = super().model_schema(schema)
        spec = schema["cls"]
        texts = descriptions(spec)
        for name, field in spec.model_fields.items():
            if name in texts:
                result["properties"][field.alias or name]["description"] = texts[name]
        return result


def json_schema() -> dict[str, Any]:
    """JSON schema of a case file, for editors that complete and check YAML."""
    schema = Case.model_json_schema(schema_generator=_Schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
