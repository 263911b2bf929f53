// As much of UnityEngine as ObliqStream.cs and the README's component name: they are compiled against it, not run.
namespace UnityEngine
{
    public static class JsonUtility { public static T FromJson<T>(string json) { return default(T); } }
    public enum TextureFormat { R8 }
    public class Texture { }
    public class Texture2D : Texture
    {
        public int width, height;
        public Texture2D(int width, int height, TextureFormat format, bool mipChain, bool linear) { }
        public void LoadRawTextureData(byte[] data) { }
        public void Apply(bool updateMipmaps) { }
    }
    public class Material { public Texture mainTexture; }
    public class Renderer { public Material material; }
    public class MonoBehaviour { public T GetComponent<T>() { return default(T); } }
}
