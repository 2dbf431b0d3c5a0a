"""Talks to `planish mcp` as a foreign client of the Model Context Protocol does: a scripted loop over all tools."""

import asyncio
import base64
import json
import sys

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client

CUBE = {
    "mesh": {
        "positions": [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
        "faces": [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    }
}


def check(holds, what):
    if not holds:
        sys.exit(what)


async def text(session, tool, arguments):
    result = await session.call_tool(tool, arguments)
    check(not result.is_error, f"{tool}: {result.content}")
    return result.content[0].text


async def picture(session, tool, arguments):
    result = await session.call_tool(tool, arguments)
    check(not result.is_error and result.content[0].type == "image", f"{tool}: {result.content}")
    check(base64.b64decode(result.content[0].data).startswith(b"\x89PNG"), f"{tool} gave no PNG")


async def loop(session):
    """What a model does that is asked for a smooth cube of at most 400 faces."""
    hello = await session.initialize()
    check(hello.server_info.name == "planish", f"another server: {hello}")
    tools = {tool.name: tool for tool in (await session.list_tools()).tools}
    check(set(tools) == {"render", "views", "validate", "estimate", "presets"}, f"other tools: {sorted(tools)}")
    check("job" in tools["render"].input_schema["properties"], "render tells no schema")
    presets = await text(session, "presets", {})
    check("catmull-clark" in presets, "the preset is not listed")
    job = {"input": CUBE, "plan": {"preset": "catmul-clark"}, "levels": 3}
    found = json.loads(await text(session, "validate", {"job": job}))
    check(not found["valid"] and "catmull-clark" in found["errors"][0]["detail"], f"no hint: {found}")
    job["plan"]["preset"] = "catmull-clark"
    check(json.loads(await text(session, "validate", {"job": job}))["valid"], "it is valid now")
    told = json.loads(await text(session, "estimate", {"job": job}))
    check(told["levels"][3]["faces"] == 384, f"another size: {told}")
    await picture(session, "views", {"job": job})
    job["outputs"] = [{"format": "png", "width": 200, "height": 150}]
    await picture(session, "render", {"job": job})
    job["outputs"] = [{"format": "stats"}]
    stats = json.loads(await text(session, "render", {"job": job}))
    check(stats["faces"] == 384 and stats["closed"], f"other stats: {stats}")
    job["levels"] = 40
    refused = await session.call_tool("estimate", {"job": job})
    check(refused.is_error and "ask for at most" in refused.content[0].text, f"not refused: {refused}")


async def main():
    server = StdioServerParameters(command=sys.argv[1], args=["mcp"])
    async with stdio_client(server) as (reading, writing), ClientSession(reading, writing) as session:
        await asyncio.wait_for(loop(session), 120)
    print("the loop is complete")


asyncio.run(main())
