"""The protocol without sockets: bytes to messages and back, what was asked, frames put together."""
